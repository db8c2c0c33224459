// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/products.h"

#include <algorithm>
#include <set>

#include "capture/workflow/failure.h"

namespace patina::workflow {

namespace fs = std::filesystem;

Facts Making::facts() const {
  Facts facts;
  facts.text("command", command);
  facts.embed("options", options);
  facts.count("seed", static_cast<std::int64_t>(seed));
  facts.text("version", version);
  std::string joined;
  for (const std::string& input : input_sha256s) joined += input + "\n";
  facts.count("inputs", static_cast<std::int64_t>(input_sha256s.size()));
  facts.text("inputs_sha256", sha256(joined).hex());
  return facts;
}

std::string freeProductId(const db::ArchiveReader& reader, const std::string& kind,
                          const std::string& of) {
  std::set<std::string> taken;
  for (const db::ProductRow& row : reader.products(kind)) taken.insert(row.id);
  std::string id;
  const std::string stem = kind + "-" + of + "-";
  for (int i = 1; id.empty() || taken.contains(id); ++i) id = stem + std::to_string(i);
  return id;
}

ProductFile placeProduct(const fs::path& archive, const std::string& id,
                         const std::string& file_name, const fs::path& out) {
  if (!out.empty()) return {id, fs::absolute(out).lexically_normal(), false};
  const fs::path folder = db::ProductWriter::folderFor(archive, id);
  fs::create_directories(folder);
  return {id, folder / file_name, true};
}

db::ProductRow recordProduct(const fs::path& archive, const ProductFile& file,
                             const std::string& kind, const std::string& run_id,
                             const Making& making, const Facts& metadata, UtcTime now) {
  db::ProductRow row;
  row.id = file.id;
  row.kind = kind;
  row.run_id = run_id;
  row.path = file.inside ? file.path.filename().string() : file.path.string();
  row.command = making.command;
  row.options_json = making.options.json();
  row.version = making.version;
  row.sha256 = sha256OfFile(file.path).hex();
  row.seed = making.seed;
  row.created_utc = now;
  row.metadata_json = metadata.json();
  row.input_sha256s = making.input_sha256s;
  db::ProductWriter::add(archive, row);
  return row;
}

fs::path pathOfProduct(const fs::path& archive, const db::ProductRow& product) {
  const fs::path path = product.path;
  return path.is_absolute() ? path : db::ProductWriter::folderFor(archive, product.id) / path;
}

db::ProductRow findProduct(const db::ArchiveReader& reader, const std::string& kind,
                           const std::string& id) {
  const std::vector<db::ProductRow> rows = reader.products(kind);
  if (rows.empty()) throw WorkflowError(Exit::kUsage, "the archive holds no " + kind + " yet");
  if (id == "latest")
    return *std::max_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
      return a.created_utc < b.created_utc;
    });
  std::vector<const db::ProductRow*> found;
  for (const db::ProductRow& row : rows) {
    if (row.id == id) return row;
    if (row.id.starts_with(id)) found.push_back(&row);
  }
  if (found.size() == 1) return *found.front();
  std::string choices;
  const std::size_t shown = found.empty() ? rows.size() : found.size();
  for (std::size_t i = 0; i < shown && i < 12; ++i)
    choices += "\n  " + (found.empty() ? rows[i].id : found[i]->id);
  throw WorkflowError(Exit::kUsage, "'" + id + "' names " +
                                        (found.empty() ? "no" : "more than one") + " " + kind +
                                        "; there are:" + choices);
}

}  // namespace patina::workflow
