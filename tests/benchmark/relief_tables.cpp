#include "tests/benchmark/relief_tables.h"
#include "common/services/count_text.h"
#include "tests/benchmark/curve_plot.h"
#include "tests/benchmark/gnuplot.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/target_rows.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace kokage {
namespace {

using Records = std::vector<ReliefRecord>;
using Field = std::optional<double> ReliefRecord::*;

bool is_plane(const ReliefRecord& r) {
    return r.view.starts_with("plane-");
}

/// Mean of a field over a method's views of the plane.
std::optional<double> plane_mean(const Records& records, const std::string& map, int size, const std::string& method,
                                 Field field) {
    double sum = 0;
    int count = 0;
    for (const ReliefRecord& r : records)
        if (r.experiment == "views" && r.map == map && r.size == size && r.method == method && is_plane(r) &&
            r.*field) {
            sum += *(r.*field);
            ++count;
        }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
}

/// How many times slower `method` is than exact.
std::optional<double> slower(const Records& records, const std::string& map, int size, const std::string& method) {
    const auto theirs = plane_mean(records, map, size, method, &ReliefRecord::ns_per_ray);
    const auto ours = plane_mean(records, map, size, "exact", &ReliefRecord::ns_per_ray);
    return theirs && ours && *ours > 0 ? std::optional(*theirs / *ours) : std::nullopt;
}

std::optional<double> most(const Records& records, const std::function<bool(const ReliefRecord&)>& picks, Field field) {
    std::optional<double> result;
    for (const ReliefRecord& r : records)
        if (picks(r) && r.*field)
            result = std::max(result.value_or(*(r.*field)), *(r.*field));
    return result;
}

/// Wrong hits, rays and ties of exact in an experiment.
struct Exactness {
    std::uint64_t rays = 0, wrong = 0, ties = 0;
};
Exactness exactness(const Records& records, const std::string& experiment) {
    Exactness sum;
    for (const ReliefRecord& r : records)
        if (r.experiment == experiment && r.method == "exact") {
            sum.rays += r.rays;
            sum.wrong += r.wrong.value_or(0);
            sum.ties += r.ties.value_or(0);
        }
    return sum;
}

std::string exactness_row(const Records& records, const std::string& experiment, const std::string& what) {
    const Exactness e = exactness(records, experiment);
    return at_most(what + " (" + count_text(e.rays) + " rays, " + count_text(e.ties) + " ties)",
                   e.rays > 0 ? std::optional(double(e.wrong)) : std::nullopt, 0, "");
}

std::string read_rows(const Records& records) {
    std::string text;
    for (const auto& [map, size, target] :
         {std::tuple("bark", 256, 11.), std::tuple("bark", 1024, 13.), std::tuple("spikes", 256, 15.)})
        text += at_most("exact: reads a ray, plane 10–85°, " + std::string(map) + " " + std::to_string(size) + "²",
                        plane_mean(records, map, size, "exact", &ReliefRecord::reads_mean), target, "");
    return text;
}

std::string speed_rows(const Records& records) {
    const auto ns = plane_mean(records, "bark", 256, "exact", &ReliefRecord::ns_per_ray);
    std::string text = at_least("exact: million rays a second on one core, bark 256²",
                                ns ? std::optional(1e3 / *ns) : std::nullopt, 10, "");
    for (const auto& [map, size, target] : {std::tuple("bark", 256, 1.5), std::tuple("spikes", 256, 2.3),
                                            std::tuple("low", 256, 2.3), std::tuple("bark", 1024, 1.)})
        text += at_least("exact: times faster than linear-128, " + std::string(map) + " " + std::to_string(size) + "²",
                         slower(records, map, size, "linear-128"), target, "");
    return text;
}

std::string summary(const Records& records) {
    std::string text = "### A plane from 10° to 85°\n\nMeans over the angles; time on one core.\n\n" +
                       markdown_row({"map", "method", "reads", "99 % of rays at most", "ns a ray",
                                     "wrong hits of 100,000", "preparation, CPU ms", "kB"}) +
                       markdown_row({"---", "---", "---:", "---:", "---:", "---:", "---:", "---:"});
    std::vector<std::tuple<std::string, int, std::string>> seen;
    for (const ReliefRecord& r : records) {
        const std::tuple key(r.map, r.size, r.method);
        if (r.experiment != "views" || !is_plane(r) || std::find(seen.begin(), seen.end(), key) != seen.end())
            continue;
        seen.push_back(key);
        double wrong = 0, rays = 0;
        for (const ReliefRecord& one : records)
            if (one.experiment == "views" && is_plane(one) && std::tuple(one.map, one.size, one.method) == key) {
                wrong += double(one.wrong.value_or(0));
                rays += double(one.rays);
            }
        const auto mean = [&](Field field) { return plane_mean(records, r.map, r.size, r.method, field); };
        text +=
            markdown_row({r.map + " " + std::to_string(r.size), r.method, three_digits(mean(&ReliefRecord::reads_mean)),
                          three_digits(mean(&ReliefRecord::reads_p99)), three_digits(mean(&ReliefRecord::ns_per_ray)),
                          three_digits(wrong / rays, 1e5), three_digits(r.preprocess_cpu_seconds, 1e3),
                          three_digits(r.bytes, 1e-3)});
    }
    return text;
}

std::string papers_figures(const Records& records) {
    std::string text =
        "\n### The paper's own experiments\n\n[D], on a Pentium M in Java: a tiled sphere with maps of 64², 51 % fewer "
        "intersection tests, 1.45 times faster; planes with maps of 32², 1.55 and 1.74 times faster; up to 1.8 at "
        "normal view; maps of 32² take 192 KB (512 maps of a byte a texel would be 512 KB). Here, against linear "
        "search of 64 steps with bisection, which is the paper's own base:\n\n" +
        markdown_row({"map", "view", "depth maps", "reads, linear → depth maps", "fewer reads", "times faster",
                      "wrong of 100,000: linear → depth maps", "kB"}) +
        markdown_row({"---", "---", "---", "---:", "---:", "---:", "---:", "---:"});
    for (const ReliefRecord& r : records) {
        if (r.experiment != "paper" || !r.method.starts_with("depth-maps"))
            continue;
        const auto base = std::find_if(records.begin(), records.end(), [&](const ReliefRecord& b) {
            return b.experiment == "paper" && b.map == r.map && b.view == r.view && b.method.starts_with("linear");
        });
        if (base == records.end() || !base->reads_mean || !r.reads_mean || !base->ns_per_ray || !r.ns_per_ray)
            continue;
        text +=
            markdown_row({r.map, r.view, r.method, three_digits(base->reads_mean) + " → " + three_digits(r.reads_mean),
                          three_digits(100 * (1 - *r.reads_mean / *base->reads_mean)) + " %",
                          three_digits(*base->ns_per_ray / *r.ns_per_ray),
                          three_digits(1e5 * double(base->wrong.value_or(0)) / double(base->rays)) + " → " +
                              three_digits(1e5 * double(r.wrong.value_or(0)) / double(r.rays)),
                          three_digits(r.bytes, 1e-3)});
    }
    return text;
}

std::vector<std::string> cells_of(const ReliefRecord& r) {
    const auto count = [](const std::optional<std::uint64_t>& n) { return n ? count_text(*n) : "–"; };
    return {r.map + " " + std::to_string(r.size),
            r.view,
            r.method,
            count_text(r.rays),
            count(r.wrong),
            count(r.ties),
            three_digits(r.reads_mean),
            three_digits(r.reads_p99),
            three_digits(r.ns_per_ray),
            three_digits(r.preprocess_cpu_seconds, 1e3),
            three_digits(r.bytes, 1e-3),
            three_digits(r.rms_error),
            r.note};
}

} // namespace

std::string relief_figures(const Records& records) {
    const auto at_1024 = [](const ReliefRecord& r) { return r.method == "exact" && r.size == 1024; };
    const auto ratio = [&]() -> std::optional<double> {
        std::optional<double> worst;
        for (const ReliefRecord& r : records)
            if (r.method == "exact" && r.bytes && r.experiment == "views")
                worst = std::max(worst.value_or(0), *r.bytes / (4. * r.size * r.size));
        return worst;
    };
    const auto occlusion = [&](const std::string& view) {
        return most(
            records,
            [&](const ReliefRecord& r) {
                return r.experiment == "occlusion" && r.method.starts_with("horizons") && r.view == view;
            },
            &ReliefRecord::rms_error);
    };
    return target_head() + exactness_row(records, "views", "exact: wrong hits") + read_rows(records) +
           speed_rows(records) +
           at_most("exact: preparation at 1024², CPU",
                   times(most(records, at_1024, &ReliefRecord::preprocess_cpu_seconds), 1e3), 60, " ms") +
           at_most("exact: memory, of the map as 32-bit floats", ratio(), 2, "") +
           exactness_row(records, "shadows", "exact: wrong shadows") +
           at_most("ambient occlusion at texels: RMS", occlusion("texels"), 0.005, "") +
           at_most("ambient occlusion between texels: RMS", occlusion("between"), 0.015, "");
}

std::string relief_tables(const Records& records) {
    std::string text = summary(records) + papers_figures(records);
    for (const char* experiment : {"views", "shadows", "occlusion", "paper"}) {
        text += "\n### " + std::string(experiment) + "\n\n" +
                markdown_row({"map", "view", "method", "rays", "wrong", "ties", "reads", "99 %", "ns a ray",
                              "preparation, CPU ms", "kB", "RMS", "note"}) +
                markdown_row(std::vector<std::string>(13, "---"));
        for (const ReliefRecord& r : records)
            if (r.experiment == experiment)
                text += markdown_row(cells_of(r));
    }
    return text;
}

std::string plot_relief(const Records& records, const std::filesystem::path& folder) {
    if (!has_gnuplot())
        return kNoGnuplot;
    Curves errors, reads;
    for (const ReliefRecord& r : records) {
        if (r.experiment != "views" || !is_plane(r))
            continue;
        if (r.map == "bark" && r.size == 256 && r.reads_mean)
            reads[r.method].emplace_back(std::stod(r.view.substr(6)), *r.reads_mean);
        if (r.ns_per_ray && r.wrong && r.rays > 0)
            errors[r.method].emplace_back(std::max(1e5 * double(*r.wrong) / double(r.rays), 0.1), *r.ns_per_ray);
    }
    if (errors.empty())
        return "plots skipped: nothing to draw";
    const char* of_reads = "set xlabel 'degrees from the normal'\nset ylabel 'reads a ray'\n"
                           "set title 'Bark of 256 x 256'\n";
    const char* of_errors = "set logscale xy\nset xlabel 'wrong hits of 100,000 (0.1: none)'\n"
                            "set ylabel 'ns a ray, one core'\nset title 'All maps and angles'\n";
    const bool drawn = draw_plot(folder / "relief-reads.svg",
                                 [&](const std::string& svg) { return curves_script(reads, of_reads, svg); }) &&
                       draw_plot(folder / "relief-error.svg", [&](const std::string& svg) {
                           return curves_script(errors, of_errors, svg, CurveStyle::points);
                       });
    return drawn ? "relief-reads.svg and relief-error.svg in " + folder.string() : "plots skipped: gnuplot failed";
}

} // namespace kokage
