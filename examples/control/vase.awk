# A vase turned on a lathe, as OBJ: awk -f vase.awk > vase.obj. Millimetres, axis z, open above; u around, v up the wall.
function radius(v) { return 17 + 9 * sin(3.6 * v + 0.35) - 9 * v + 7 * v * v * v * v }
BEGIN {
  around = 64; up = 40; pi = atan2(0, -1)
  for (j = 0; j <= up; j++)
    for (i = 0; i <= around; i++) {
      a = 2 * pi * (i % around) / around
      printf "v %.3f %.3f %.3f\nvt %.5f %.5f\n", radius(j / up) * cos(a), radius(j / up) * sin(a), 62 * j / up, i / around, j / up
    }
  for (j = 0; j < up; j++)
    for (i = 0; i < around; i++) {
      a = j * (around + 1) + i + 1; b = a + 1; c = b + around + 1; d = c - 1
      printf "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, b, c, c, d, d
    }
}
