// SPDX-License-Identifier: GPL-3.0-or-later
// What a client sends to the virtual DSLR: packets, commands, and the data sets within; and what is
// sent to its lamps.
#include <algorithm>

#include "devices/twin/dslr/camera_settings.h"
#include "devices/twin/dslr/op_dmx.h"
#include "devices/twin/dslr/ptpip_packets.h"
#include "processing/image/failure.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

using namespace devices::twin::dslr;

// What becomes of a stream that arrives in pieces of `piece` bytes.
struct Heard {
  std::vector<PtpCommand> commands;
  bool bad = false;
};

Heard hear(std::span<const std::byte> bytes, std::size_t piece) {
  PacketReader packets;
  CommandReader commands;
  Heard heard;
  while (!bytes.empty() && !heard.bad) {
    const auto part = bytes.first(std::min(piece, bytes.size()));
    bytes = bytes.subspan(part.size());
    packets.feed(part);
    while (!heard.bad) {
      const auto packet = packets.next();
      if (!packet) break;
      PATINA_CHECK(packet->payload.size() < PacketReader::kPacketBytesMax);
      connectionOf(*packet);
      if (const auto command = commands.take(*packet)) heard.commands.push_back(*command);
      heard.bad = commands.bad();
    }
    heard.bad = heard.bad || packets.bad();
  }
  return heard;
}

}  // namespace

void fuzzPtpIp(std::span<const std::byte> bytes) {
  const Heard whole = hear(bytes, bytes.size() + 1), pieces = hear(bytes, 7);
  PATINA_CHECK(whole.bad == pieces.bad && whole.commands.size() == pieces.commands.size());
  CameraSettings settings({64, 48});
  for (std::size_t i = 0; i < whole.commands.size(); ++i) {
    const PtpCommand& command = whole.commands[i];
    PATINA_CHECK(command.data == pieces.commands[i].data);
    PATINA_CHECK(command.parameters.size() <= 5);
    PATINA_CHECK(command.data.size() <= CommandReader::kDataBytesMax);
    const auto property = static_cast<Property>(command.parameter(0));
    settings.write(property, command.data);
    if (const Setting* const setting = settings.find(property);
        setting != nullptr && setting->form == Form::kChoices && setting->type != DataType::kText)
      PATINA_CHECK(std::ranges::find(setting->choices, setting->value) != setting->choices.end());
    PtpReader(command.data).text();
  }
}

void fuzzOpDmx(std::span<const std::byte> bytes) {
  if (const auto frame = parseOpDmx(bytes))
    PATINA_CHECK(frame->slots.size() <= 512 && frame->universe < 1 << 15);
}

}  // namespace patina::testing
