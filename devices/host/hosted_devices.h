// SPDX-License-Identifier: GPL-3.0-or-later
// Devices whose drivers run in another process: the contracts of devices/, kept by deadline.
//
// A call that is not answered in time ends its process by SIGKILL: the answer is kTimeout, and the
// device is lost until recover(), whatever the rung, has started the process anew. So a driver may
// hang, leak or crash. The limits are real time, also on a clock that is told.
//   recover  retry and drain go to the driver; reopen too, and when the driver does not manage, its
//            process is started anew; reset and power cycle start it anew first.
//   poll     starts the process of a camera anew after `recycle_shots` shots or above
//            `recycle_bytes` of memory, applies the last settings again and reads them back.
//   collect  hands over each file with what the process made of it (RawFrame::seen). A file whose
//            decoder died or hung comes as `refused`.
#pragma once

#include <memory>

#include "devices/camera.h"
#include "devices/host/driver_link.h"
#include "devices/light.h"
#include "devices/sensor.h"
#include "devices/trigger.h"

namespace patina::devices::host {

struct CameraLimits {
  Nanoseconds call = std::chrono::seconds(10);  // of a call that has no deadline of its own
  // Of recover() where the camera is opened, once or twice, and of poll() where it recycles.
  Nanoseconds opening = std::chrono::seconds(10);
  int recycle_shots = 2000;
  std::uint64_t recycle_bytes = 512ull << 20;
};

// `place`: of the device in the link's hello. The clock outlives them. Camera: `caps` as the driver
// gives them before it is opened. A link may serve several devices: they go down together, and none
// of them is recycled.
std::unique_ptr<Camera> makeHostedCamera(CameraCaps caps, std::shared_ptr<DriverLink> link,
                                         std::uint16_t place, CameraLimits limits, Clock& clock);
std::unique_ptr<Light> makeHostedLight(LightCaps caps, std::shared_ptr<DriverLink> link,
                                       std::uint16_t place);
std::unique_ptr<Sensor> makeHostedSensor(SensorCaps caps, std::shared_ptr<DriverLink> link,
                                         std::uint16_t place);
std::unique_ptr<Trigger> makeHostedTrigger(std::string id, std::shared_ptr<DriverLink> link,
                                           std::uint16_t place);

}  // namespace patina::devices::host
