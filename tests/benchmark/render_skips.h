#pragma once
// What pictures leave out, measured: the same picture with and without, on scenes where it matters.
#include "common/services/progress.h"
#include "tests/benchmark/render_plan.h"
#include "tests/benchmark/render_record.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace kokage {

/// Draws each pair at a quarter of the plan's pixels and hands out its records, method "skip: WHAT", effort "on" and
/// "off": CPU time (the least of three; with loading, where that is what differs), and how far the two pictures are
/// apart. `folder`: as render_scenes().
void measure_skips(const RenderPlan& plan, const std::filesystem::path& data, const std::filesystem::path& folder,
                   Progress& progress, const std::function<void(const PictureRecord&)>& take);

/// A row for each pair.
std::string skip_table(const std::vector<PictureRecord>& records);

} // namespace kokage
