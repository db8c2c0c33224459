// SPDX-License-Identifier: GPL-3.0-or-later
// Each row type's columns, said once: the same list binds SQL, reads results, and writes and reads
// journal lines. A visitor is called as visitor(name, field&). Internal to db/.
#pragma once

#include <concepts>

#include "db/tables.h"

namespace patina::db {

// Zero, or the empty text, stands for NULL in the table.
template <class T>
struct OrNull {
  T& value;
};
template <class T>
OrNull(T&) -> OrNull<T>;

template <class T, class Row>
concept Is = std::same_as<std::remove_const_t<T>, Row>;

template <class V>
void columns(V&& v, Is<DeviceRow> auto& r) {
  v("id", r.id), v("kind", r.kind), v("backend", r.backend), v("serial", r.serial),
      v("description", r.description);
}
template <class V>
void columns(V&& v, Is<SpecimenRow> auto& r) {
  v("id", r.id), v("name", r.name), v("process", r.process), v("description", r.description),
      v("licence", r.licence);
}
template <class V>
void columns(V&& v, Is<RigRecord> auto& r) {
  v("id", r.id), v("name", r.name), v("sha256", r.sha256), v("toml", r.toml);
}
template <class V>
void columns(V&& v, Is<RunRecord> auto& r) {
  v("id", r.row.id), v("specimen_id", r.specimen_id), v("rig_id", r.rig_id),
      v("plan_toml", r.row.plan_toml), v("plan_sha256", r.row.plan_sha256),
      v("rig_toml", r.row.rig_toml), v("boot_id", r.row.boot_id), v("t0_utc_ns", r.row.t0_utc),
      v("t0_boot_ns", r.row.t0_boot), v("seed", r.row.seed), v("state", r.row.state),
      v("interval_ns", r.row.interval), v("duration_ns", r.row.duration), v("number", r.row.number);
}
template <class V>
void columns(V&& v, Is<StepRow> auto& r) {
  v("id", r.id), v("run_id", r.run_id), v("number", r.number), v("due_utc_ns", r.due_utc),
      v("decision", r.decision), v("reason", r.reason), v("retries", r.retries),
      v("held_ns", r.held), v("spread_ns", r.spread), v("shots_due", r.shots_due),
      v("shots_captured", r.shots_captured);
}
template <class V>
void columns(V&& v, Is<ShotRow> auto& r) {
  v("id", r.id), v("step_id", r.step_id), v("device_id", r.device_id),
      v("light_state", r.light_state), v("exposure_index", r.exposure_index),
      v("attempt", r.attempt), v("exposure_ns", r.exposure), v("iso", r.iso),
      v("f_number", r.f_number), v("began_utc_ns", r.began_utc), v("began_mono_ns", r.began_mono),
      v("state", r.state);
}
template <class V>
void columns(V&& v, Is<FrameRecord> auto& r) {
  v("id", r.row.id), v("run_id", r.run_id), v("shot_id", r.row.shot_id),
      v("file_index", r.row.file_index), v("sha256", r.row.sha256), v("ext", r.row.ext),
      v("bytes", r.row.bytes), v("width_px", r.row.size.width), v("height_px", r.row.size.height),
      v("utc_ns", r.row.utc), v("mono_ns", r.row.mono), v("acked_utc_ns", r.row.acked_utc),
      v("saturated_fraction", r.row.saturated_fraction), v("missing", r.row.missing);
}
template <class V>
void columns(V&& v, Is<ReadingRow> auto& r) {
  v("id", r.id), v("run_id", r.run_id), v("step_id", r.step_id), v("device_id", r.device_id),
      v("quantity", r.quantity), v("unit", r.unit), v("value", r.value), v("utc_ns", r.utc),
      v("quality", r.quality);
}
template <class V>
void columns(V&& v, Is<LightCheckRow> auto& r) {
  v("id", r.id), v("run_id", r.run_id), v("step_id", OrNull{r.step_id}), v("shot_id", r.shot_id),
      v("light_state", r.light_state), v("exposure_index", r.exposure_index), v("source", r.source),
      v("channel", r.channel), v("level", r.level), v("baseline", r.baseline), v("ratio", r.ratio),
      v("gain", r.gain), v("verdict", r.verdict), v("utc_ns", r.utc);
}
template <class V>
void columns(V&& v, Is<CalibrationRow> auto& r) {
  v("id", r.id), v("kind", r.kind), v("device_id", r.device_id), v("exposure_ns", r.exposure),
      v("iso", r.iso), v("width_px", r.size.width), v("height_px", r.size.height),
      v("temperature_c", r.temperature_c), v("light_state", r.light_state), v("utc_ns", r.utc),
      v("sha256", r.sha256), v("value_json", r.value_json);
}
template <class V>
void columns(V&& v, Is<FrameCalibrationRow> auto& r) {
  v("frame_id", r.frame_id), v("calibration_id", r.calibration_id),
      v("distance_time_s", r.distance_time_s),
      v("distance_temperature_k", r.distance_temperature_k),
      v("within_tolerance", r.within_tolerance);
}
template <class V>
void columns(V&& v, Is<ProductRow> auto& r) {
  v("id", r.id), v("kind", r.kind), v("run_id", OrNull{r.run_id}), v("path", r.path),
      v("command", r.command), v("options_json", r.options_json), v("version", r.version),
      v("sha256", r.sha256), v("seed", r.seed), v("created_utc_ns", r.created_utc),
      v("metadata_json", r.metadata_json);
}
template <class V>
void columns(V&& v, Is<ProductInputRecord> auto& r) {
  v("product_id", r.product_id), v("position", r.position), v("sha256", r.sha256);
}
template <class V>
void columns(V&& v, Is<EventRow> auto& r) {
  v("id", r.id), v("run_id", OrNull{r.run_id}), v("utc_ns", r.utc), v("kind", r.kind),
      v("detail", r.detail);
}

}  // namespace patina::db
