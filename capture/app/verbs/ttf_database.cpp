// SPDX-License-Identifier: GPL-3.0-or-later
// patina ttf info | list | search | show | plate | publish: the textures of an archive as a
// database.
#include "capture/workflow/ttf_database.h"

#include "capture/app/context.h"
#include "capture/app/verbs/ttf_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/pictures.h"
#include "capture/workflow/product_calibrations.h"
#include "capture/workflow/products.h"
#include "processing/image/picture_file.h"
#include "processing/ttf/ttf_file.h"

namespace patina::app {
namespace {

Item entryItem(const workflow::TtfEntry& entry) {
  const auto optional = [](const std::optional<double>& v) { return v ? Value{*v} : Value{}; };
  Item item;
  item.set("id", entry.id.c_str())
      .set("specimen", entry.specimen.c_str())
      .set("process", entry.process.c_str())
      .set("frames", entry.frames)
      .set("interval_ns", entry.interval)
      .set("duration_ns", entry.duration)
      .set("light", entry.light.c_str())
      .set("width_px", entry.width_px)
      .set("height_px", entry.height_px)
      .set("humidity_percent", optional(entry.humidity_percent))
      .set("licence", entry.licence.c_str())
      .hidden("camera", Value{entry.camera})
      .hidden("temperature_c", optional(entry.temperature_c))
      .hidden("run_id", Value{entry.run_id})
      .hidden("t0_utc_ns", Value{toNs(entry.t0_utc)})
      .hidden("path", Value{entry.path.string()})
      .hidden("there", Value{entry.there})
      .hidden("sha256", Value{entry.sha256});
  return item;
}

void search(Context& context, const workflow::TtfQuery& query) {
  const db::ArchiveReader reader(context.archive());
  for (const workflow::TtfEntry& entry : workflow::searchTtfs(reader, query)) {
    if (!entry.there) context.warn("the file of " + entry.id + " is gone: " + entry.path.string());
    context.out.add(entryItem(entry));
  }
}

void show(Context& context, const std::string& id) {
  const db::ArchiveReader reader(context.archive());
  const workflow::TtfEntry entry = workflow::findTtf(reader, id);
  context.out.asList();
  Item item = entryItem(entry);
  item.set("file", entry.path.c_str()).set("options_json", entry.options_json.c_str());
  item.set("made_utc_ns", entry.created_utc);
  context.out.add(std::move(item));
}

void info(Context& context, const std::string& in) {
  std::filesystem::path file = in;
  if (!std::filesystem::exists(file)) {
    if (context.options.archive.empty())
      throw AppError(Exit::kUsage,
                     "there is no file " + in + "; for one of an archive give --archive DIR too");
    file = workflow::findTtf(db::ArchiveReader(context.archive()), in).path;
  }
  std::vector<std::string> calibrations, left;
  if (!context.options.archive.empty()) {
    const db::ArchiveReader archive(context.archive());
    for (const db::ProductRow& product : archive.products("ttf"))
      if (workflow::pathOfProduct(archive.folder(), product) == file) {
        calibrations = workflow::textsOf(workflow::calibrationsOf(archive, product));
        left = workflow::Facts::parse(product.metadata_json).texts("calibrations_left");
      }
  }
  const ttf::TtfReader reader(file);
  const ttf::TtfInfo& info = reader.info();
  const char* types[] = {"u16", "f16", "f32"};
  const double first = info.time_s.empty() ? 0 : info.time_s.front();
  const double last = info.time_s.empty() ? 0 : info.time_s.back();
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", file.c_str())
                                .set("frames", info.frames)
                                .set("width_px", info.width)
                                .set("height_px", info.height)
                                .set("channels", info.channels)
                                .set("type", types[static_cast<int>(info.type)])
                                .set("scale", Value{info.scale})
                                .set("mm_per_texel", Value{info.mm_per_texel})
                                .set("t0_utc_ns", info.t0_utc)
                                .set("first_s", Value{first})
                                .set("last_s", Value{last})
                                .set("calibrations", Value{calibrations})
                                .set("calibrations_left", Value{left})
                                .set("provenance_json", info.provenance_json.c_str())));
}

struct Publish {
  std::string id, to, licence;
};
void publish(Context& context, const Publish& options) {
  const db::ArchiveReader reader(context.archive());
  const workflow::TtfEntry entry = workflow::findTtf(reader, options.id);
  const std::string licence = options.licence.empty() ? entry.licence : options.licence;
  workflow::publishTtf(entry, licence, options.to);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("id", entry.id.c_str())
                                .set("path", options.to.c_str())
                                .set("licence", licence.c_str())));
}

struct Plate {
  std::string out;
  std::vector<std::string> textures;
  int columns = 8, cell = 150;
};
// Files, textures of the archive, or, when none is named, all of the archive.
void plate(Context& context, const Plate& options) {
  std::vector<workflow::PlateSubject> subjects;
  const auto add = [&subjects](const workflow::TtfEntry& entry) {
    subjects.push_back(
        {entry.specimen,
         entry.interval > Nanoseconds{}
             ? formatDuration(entry.duration) + ", every " + formatDuration(entry.interval)
             : formatDuration(entry.duration),
         workflow::sequenceOfTtf(entry.path)});
  };
  std::vector<std::string> names = options.textures;
  if (names.empty())
    for (const workflow::TtfEntry& entry : workflow::listTtfs(db::ArchiveReader(context.archive())))
      if (entry.there) names.push_back(entry.id);
  for (const std::string& name : names) {
    if (std::filesystem::is_regular_file(name))
      subjects.push_back(
          {std::filesystem::path(name).stem().string(), "", workflow::sequenceOfTtf(name)});
    else
      add(workflow::findTtf(db::ArchiveReader(context.archive()), name));
  }
  if (subjects.empty()) throw AppError(Exit::kUsage, "the archive holds no texture yet");
  const Image<std::uint8_t> picture =
      workflow::makePlate(subjects, options.columns, options.cell, context.progress);
  writePng(options.out, picture.view());
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("rows", subjects.size())
                                .set("width_px", picture.width())
                                .set("height_px", picture.height())));
}

void addSearch(Verb& ttf) {
  auto q = std::make_shared<workflow::TtfQuery>();
  const auto into = [](std::optional<double>& v) {
    return [&v](const std::string& text) { v = std::stod(text); };
  };
  ttf.verb("search", "Textures by what they show", "patina ttf search ripening --archive ivy",
           [q](Context& context) { search(context, *q); })
      .list("WORD", q->words, "In any field, whatever its case")
      .option("--process", q->process, "NAME", "What happens: ripening ...")
      .option("--specimen", q->specimen, "NAME", "To what")
      .option("--light", q->light, "STATE", "Under which light")
      .option("--licence", q->licence, "NAME", "Who may use it")
      .take(
          "--frames", "N", [q](const std::string& text) { q->frames_least = std::stoll(text); },
          "At least so many")
      .option("--interval", q->interval_most, parseDuration, "TIME", "At most so far apart")
      .option("--duration", q->duration_least, parseDuration, "TIME", "At least so long")
      .take("--humidity-from", "PERCENT", into(q->humidity_least), "At least so humid")
      .take("--humidity-to", "PERCENT", into(q->humidity_most), "At most so humid");
}

}  // namespace

void addTtfDatabase(Verb ttf) {
  ttf.verb("list", "The textures of an archive", "patina ttf list --archive ivy",
           [](Context& context) { search(context, {}); });
  addSearch(ttf);
  auto shown = std::make_shared<std::string>();
  ttf.verb("show", "All about one of them", "patina ttf show latest --archive ivy",
           [shown](Context& context) { show(context, *shown); })
      .required("ID", *shown, "Its id, a prefix of one, or latest");
  auto file = std::make_shared<std::string>();
  ttf.verb("info", "What a texture's file holds", "patina ttf info ivy.h5",
           [file](Context& context) { info(context, *file); })
      .required("FILE", *file, "A .h5 file, or the id of a texture of the archive");
  auto plate_options = std::make_shared<Plate>();
  ttf.verb("plate", "Rows of textures over time", "patina ttf plate plate.png --archive ivy",
           [plate_options](Context& context) { plate(context, *plate_options); })
      .required("OUT", plate_options->out, "The picture to write: .png")
      .list("TTF", plate_options->textures, "Files or ids (default: all of the archive)")
      .option("--columns", plate_options->columns, 2, 100, "Times a row")
      .option("--cell", plate_options->cell, 32, 2048, "Side of a picture, in pixels");
  auto p = std::make_shared<Publish>();
  ttf.verb("publish", "A folder that stands alone: the file, its description, its licence",
           "patina ttf publish latest --to banana-ttf --licence CC-BY-4.0 --archive ivy",
           [p](Context& context) { publish(context, *p); })
      .required("ID", p->id, "Its id, a prefix of one, or latest")
      .option("--to", p->to, "FOLDER", "Where to")
      .demand("--to")
      .option("--licence", p->licence, "NAME", "Who may use it (default: as recorded)");
}

void addTtfVerbs(Verb root) {
  Verb ttf = root.group("ttf", "Time-varying textures (TTF)");
  addTtfBuild(ttf);
  addTtfRetime(ttf);
  addTtfKey(ttf);
  addTtfDatabase(ttf);
}

}  // namespace patina::app
