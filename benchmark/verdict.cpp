#include "benchmark/verdict.h"

#include <cmath>
#include <cstdio>
#include <variant>

namespace tissue_contact {
namespace {

int refinedCount(int cells, double factor) { return static_cast<int>(std::ceil(cells * factor - 1e-9)); }

template <typename Cells>
std::string listText(const Cells& cells) {
  std::string text;
  for (const int count : cells) text += (text.empty() ? "" : ", ") + std::to_string(count);
  return "[" + text + "]";
}

/// Nodes after refining; 0 for meshes from files.
double refine(TissueDescription& tissue, double factor) {
  double nodes = 1.0;
  if (auto* const block = std::get_if<BlockDescription>(&tissue.geometry)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int cells = refinedCount(block->cells[axis], factor);
      block->grading[axis].growth =
          std::pow(block->grading[axis].growth, static_cast<double>(block->cells[axis]) / cells);
      block->cells[axis] = cells;
      nodes *= cells + 1.0;
    }
    return nodes;
  }
  if (auto* const sheet = std::get_if<SheetDescription>(&tissue.geometry)) {
    for (int& cells : sheet->cells) {
      cells = refinedCount(cells, factor);
      nodes *= cells + 1.0;
    }
    return nodes;
  }
  return 0.0;
}

}  // namespace

ErrorVerdict judgeErrors(const std::vector<ErrorSource>& sources) {
  ErrorVerdict verdict;
  double largest = kSmallError;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!(sources[i].estimate > largest)) continue;
    largest = sources[i].estimate;
    verdict.dominating = static_cast<int>(i);
  }
  char text[400];
  if (verdict.dominating < 0) {
    std::snprintf(text, sizeof text, "No source of error that was measured exceeds %.0f %%: keep the settings.",
                  100.0 * kSmallError);
  } else {
    const ErrorSource& source = sources[static_cast<std::size_t>(verdict.dominating)];
    const double percent = 100.0 * source.estimate;
    if (source.remedy.empty()) {
      std::snprintf(text, sizeof text, "The %s dominates: about %.1f %%. None of the settings tried leaves less.",
                    source.name.c_str(), percent);
    } else {
      std::snprintf(text, sizeof text, "The %s dominates: about %.1f %%. Change %s: costs %.1f times the time.",
                    source.name.c_str(), percent, source.remedy.c_str(), source.cost);
    }
  }
  verdict.summary = text;
  return verdict;
}

std::optional<Scene> refinedScene(const Scene& scene, double factor, double most_nodes) {
  Scene refined = scene;
  double nodes = 0.0;
  for (TissueDescription& tissue : refined.tissues) nodes += refine(tissue, factor);
  if (nodes == 0.0 || nodes > most_nodes) return std::nullopt;
  return refined;
}

std::string cellsText(const Scene& scene) {
  std::string text;
  for (const TissueDescription& tissue : scene.tissues) {
    std::string cells;
    if (const auto* block = std::get_if<BlockDescription>(&tissue.geometry)) cells = listText(block->cells);
    if (const auto* sheet = std::get_if<SheetDescription>(&tissue.geometry)) cells = listText(sheet->cells);
    if (!cells.empty()) text += (text.empty() ? "" : "; ") + tissue.name + ": cells: " + cells;
  }
  return text;
}

}  // namespace tissue_contact
