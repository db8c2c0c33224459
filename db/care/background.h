// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace patina::db::care {

// From now on the calling thread reads and writes only when nobody else wants the disk (idle I/O
// class, where the disk's scheduler has classes), and computes after all others. A hint: answers
// false where the system refuses.
bool giveWay();

}  // namespace patina::db::care
