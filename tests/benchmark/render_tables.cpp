#include "tests/benchmark/render_tables.h"
#include "tests/benchmark/curve_plot.h"
#include "tests/benchmark/effort_curve.h"
#include "tests/benchmark/gnuplot.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/target_rows.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

using Records = std::vector<PictureRecord>;

std::vector<std::string> scenes_of(const Records& records) {
    std::vector<std::string> names;
    for (const PictureRecord& r : records)
        if (std::find(names.begin(), names.end(), r.scene) == names.end())
            names.push_back(r.scene);
    return names;
}

/// The cheapest fast picture that keeps the promised error; if there is none, the best.
const PictureRecord* promised(const Records& records, const std::string& scene) {
    const PictureRecord *best = nullptr, *cheapest = nullptr;
    for (const PictureRecord& r : records) {
        if (r.scene != scene || r.method != "fast" || !r.mean_error)
            continue;
        if (!best || *r.mean_error < *best->mean_error)
            best = &r;
        if (*r.mean_error <= 0.03 && (!cheapest || r.cpu_seconds < cheapest->cpu_seconds))
            cheapest = &r;
    }
    return cheapest ? cheapest : best;
}

std::string kinds_text(const PictureRecord& r) {
    std::string text;
    for (const auto& [kind, error] : r.mean_error_of)
        text += (text.empty() ? "" : ", ") + kind + " " + three_digits(error, 100);
    return text;
}

} // namespace

std::optional<double> times_less_cpu(const Records& records, const PictureRecord& fast) {
    if (!is_judged(fast) || !(fast.cpu_seconds > 0))
        return std::nullopt;
    std::vector<EffortPoint> points;
    for (const PictureRecord& r : records)
        if (r.scene == fast.scene && r.method == "path-traced" && is_judged(r) && r.cpu_seconds > 0)
            points.push_back({r.cpu_seconds, *r.mean_error});
    if (points.empty())
        return std::nullopt;
    std::optional<double> cpu = cpu_at_error(points, *fast.mean_error);
    if (!cpu) {
        const EffortPoint& nearest =
            *std::min_element(points.begin(), points.end(), [&](const EffortPoint& a, const EffortPoint& b) {
                return std::abs(std::log(a.error / *fast.mean_error)) < std::abs(std::log(b.error / *fast.mean_error));
            });
        cpu = nearest.cpu_seconds * std::pow(nearest.error / *fast.mean_error, 2);
    }
    return *cpu / fast.cpu_seconds;
}

void compare_times(Records& records) {
    for (PictureRecord& r : records)
        if (r.method == "fast")
            r.times_less_cpu_than_path_tracing = times_less_cpu(records, r);
}

std::string render_figures(const Records& records) {
    std::string text = target_head();
    for (const std::string& scene : scenes_of(records)) {
        const PictureRecord* fast = promised(records, scene);
        if (!fast)
            continue;
        const std::string what = scene + ", " + fast->effort + " (" + three_digits(fast->cpu_seconds) + " CPU-s)";
        text += at_most(what + ": mean error" + (is_judged(*fast) ? "" : " (not judged: the truth is too noisy)"),
                        times(fast->mean_error, 100), 3, " %");
        text += at_least(what + ": times less CPU than path tracing at that error", times_less_cpu(records, *fast), 20,
                         "×");
    }
    return text;
}

std::string render_tables(const Records& records) {
    std::string text =
        markdown_row({"scene", "method", "effort", "CPU s", "transport", "solve", "render", "mean error %", "p95 %",
                      "bias %", "reference noise %", "times less CPU", "mean error by kind %"}) +
        markdown_row(std::vector<std::string>(13, "---"));
    for (const PictureRecord& r : records)
        text += markdown_row({r.scene, r.method, r.effort, three_digits(r.cpu_seconds),
                              three_digits(r.transport_cpu_seconds), three_digits(r.solve_cpu_seconds),
                              three_digits(r.render_cpu_seconds), three_digits(r.mean_error, 100),
                              three_digits(r.p95_error, 100), three_digits(r.bias, 100),
                              three_digits(r.reference_noise, 100) + (is_judged(r) ? "" : " (not judged)"),
                              r.method == "fast" ? three_digits(times_less_cpu(records, r)) : "—", kinds_text(r)});
    return text;
}

std::string plot_render(const Records& records, const std::filesystem::path& folder) {
    if (!has_gnuplot())
        return kNoGnuplot;
    std::string drawn;
    for (const std::string& scene : scenes_of(records)) {
        Curves curves;
        for (const PictureRecord& r : records)
            if (r.scene == scene && r.mean_error)
                curves[r.method].emplace_back(r.cpu_seconds, 100 * *r.mean_error);
        for (auto& [name, points] : curves)
            std::sort(points.begin(), points.end());
        const std::string file = "render-" + scene + ".svg";
        const bool done = draw_plot(folder / file, [&](const std::string& to) {
            return curves_script(curves,
                                 "set logscale xy\nset xlabel 'CPU seconds'\nset ylabel 'mean error, % of the mean "
                                 "radiance'\nset title '" +
                                     scene + "'\n",
                                 to);
        });
        drawn += done ? (drawn.empty() ? "plots: " : ", ") + file : "";
    }
    return drawn.empty() ? "plots skipped: gnuplot failed" : drawn;
}

} // namespace kokage
