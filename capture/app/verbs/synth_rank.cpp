// SPDX-License-Identifier: GPL-3.0-or-later
// patina synth rank: how many components a texture's histories need.
#include <algorithm>
#include <filesystem>

#include "capture/app/context.h"
#include "capture/app/verbs/synth_verbs.h"
#include "processing/image/picture_file.h"
#include "processing/render/chart.h"
#include "processing/synthesis/quilting/history_regret.h"
#include "processing/synthesis/quilting/quilting.h"
#include "processing/synthesis/quilting/rank_regret.h"
#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::app {
namespace {

constexpr int kPlacements = 40;
constexpr int kRanks[] = {1, 2, 3, 5, 8, 10, 15, 20, 30, 40, 60};

struct Options {
  std::string in, chart;
  quilting::QuiltingOptions quilting;
  int most = 80, histories = 12;
};

void draw(const std::string& file, const std::vector<double>& error_of_rank) {
  render::Chart chart;
  chart.title = "What so many components leave out";
  chart.x_label = "components";
  chart.y_label = "relative RMS error, %";
  render::ChartLine line;
  line.colour = {31, 95, 160};
  for (std::size_t k = 0; k < error_of_rank.size(); ++k) {
    line.x.push_back(static_cast<double>(k) + 1);
    line.y.push_back(100 * error_of_rank[k]);
  }
  chart.lines.push_back(std::move(line));
  chart.y_low = 0;
  if (std::filesystem::path(file).extension() == ".svg")
    writeFileAtomically(file, render::chartSvg(chart));
  else
    writePng(file, render::drawChart(chart).view());
}

void rank(Context& context, const Options& options) {
  const std::string extension = std::filesystem::path(options.chart).extension();
  if (!options.chart.empty() && extension != ".png" && extension != ".svg")
    throw AppError(Exit::kUsage,
                   "--chart is written as .png or .svg, not as '" + options.chart + "'");
  const ttf::TtfReader input(options.in);
  const quilting::QuiltingSource source(input, nullptr);
  options.quilting.check(source.size());
  const quilting::TtfFeatures f =
      quilting::ttfFeatures(source, options.most, std::nullopt, context.progress);
  std::vector<int> ranks;
  for (int k : kRanks)
    if (k <= f.features.channels()) ranks.push_back(k);
  const SizePx block = options.quilting.blockFor(source.size());
  const SizePx overlap = options.quilting.overlapFor(block);
  const std::vector<quilting::Placement> placements = quilting::drawPlacements(
      {source.size().width - block.width + 1, source.size().height - block.height + 1}, kPlacements,
      context.seed());
  const std::vector<quilting::RankRegret> regrets =
      quilting::rankRegret(f.features.view(), ranks, block, overlap, placements, context.progress);
  std::vector<quilting::HistoryRegret> over_frames;
  if (options.histories > 0) {
    const std::vector<quilting::Placement> some(
        placements.begin(), placements.begin() + std::min(options.histories, kPlacements));
    over_frames =
        quilting::historyRegret(source, f.weight, block, overlap, some, regrets, context.progress);
  }
  for (std::size_t i = 0; i < regrets.size(); ++i) {
    const quilting::RankRegret& r = regrets[i];
    Item item;
    item.set("rank", r.rank)
        .set("error", Value{f.error_of_rank[static_cast<std::size_t>(r.rank) - 1]})
        .set("regret", Value{r.mean})
        .set("same_choice_share", Value{r.same_share});
    if (!over_frames.empty())
      item.set("regret_frames", Value{over_frames[i].mean})
          .set("same_choice_share_frames", Value{over_frames[i].same_share});
    context.out.add(std::move(item));
  }
  if (!options.chart.empty()) draw(options.chart, f.error_of_rank);
}

}  // namespace

void addSynthRankVerb(Verb synth) {
  auto o = std::make_shared<Options>();
  synth
      .verb("rank",
            "What comparing by few components leaves out, and how much worse the blocks chosen so "
            "are than those chosen by all",
            "patina synth rank ivy.h5 --chart rank.svg",
            [o](Context& context) { rank(context, *o); })
      .required("IN", o->in, "A texture's .h5 file")
      .option("--most", o->most, 1, 1000, "Components that stand for all (default: 80)")
      .option(
          "--histories", o->histories, 0, kPlacements,
          "Placements that are judged over all frames too, from the file (default: 12; 0: none)")
      .option("--block", o->quilting.block_px, parseSize, "WxH",
              "Of the blocks compared (default: a sixth of the sample)")
      .option("--chart", o->chart, "FILE", "The curve of errors too: .png or .svg");
}

}  // namespace patina::app
