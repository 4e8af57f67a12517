#include "tests/benchmark/tree_tables.h"
#include "common/services/count_text.h"
#include "tests/benchmark/gnuplot.h"
#include "tests/benchmark/markdown.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace kokage {

namespace {

constexpr std::uint64_t kJudgedLeaves = 100000;
constexpr double kSkeletonAndLeavesTarget = 0.1, kBarkTarget = 0.3; // CPU seconds

using Curve = std::vector<std::pair<double, double>>; ///< leaves, value; rising leaves

Curve curve_of(const std::vector<TreeRecord>& records, const std::string& generator, const std::string& species,
               double (*value)(const TreeRecord&)) {
    Curve curve;
    for (const TreeRecord& record : records)
        if (record.generator == generator && record.species == species && record.leaves > 0 && value(record) > 0)
            curve.emplace_back(double(record.leaves), value(record));
    std::sort(curve.begin(), curve.end());
    return curve;
}

double cpu_of(const TreeRecord& record) {
    return record.cpu_seconds;
}

/// The slowest of our species at the judged number of leaves.
std::string judged_row(const std::vector<TreeRecord>& records, const char* what, double target,
                       std::optional<double> TreeRecord::*seconds) {
    const TreeRecord* slowest = nullptr;
    for (const TreeRecord& record : records)
        if (record.leaves == kJudgedLeaves && record.*seconds &&
            (!slowest || *(record.*seconds) > *(slowest->*seconds)))
            slowest = &record;
    if (!slowest)
        return markdown_row({what, "–", "≤ " + three_digits(target) + " s", "not measured"});
    const double measured = *(slowest->*seconds);
    return markdown_row({std::string(what) + " (slowest: " + slowest->species + ")", three_digits(measured) + " s",
                         "≤ " + three_digits(target) + " s", measured <= target ? "met" : "**short**"});
}

/// A peer's median time over ours (the oak's) at the same number of leaves.
std::string ratio_row(const std::vector<TreeRecord>& records, const std::string& peer) {
    std::vector<double> ratios;
    for (const TreeRecord& record : records)
        if (record.generator == peer)
            if (const auto ours = cpu_seconds_at(records, "kokage", "oak", double(record.leaves)))
                ratios.push_back(record.cpu_seconds / *ours);
    if (ratios.empty())
        return "";
    std::sort(ratios.begin(), ratios.end());
    return markdown_row({peer + "'s CPU over our oak's at as many leaves, median of " + std::to_string(ratios.size()),
                         three_digits(ratios[ratios.size() / 2]), "", ""});
}

std::string plot_script(const std::vector<TreeRecord>& records, const std::string& what,
                        double (*value)(const TreeRecord&), const std::string& file) {
    std::map<std::string, Curve> curves;
    for (const TreeRecord& record : records)
        curves.try_emplace(record.generator + ": " + record.species,
                           curve_of(records, record.generator, record.species, value));
    std::ostringstream script;
    script << "set terminal svg size 860,520 background 'white'\nset output '" << file << "'\n"
           << "set logscale xy\nset format x '%.0s%c'\nset grid\nset key outside\nset xlabel 'leaves'\nset ylabel '"
           << what << "'\n";
    std::size_t index = 0;
    for (const auto& [name, curve] : curves) {
        script << "$data" << index++ << " << END\n";
        for (const auto& [leaves, y] : curve)
            script << leaves << " " << y << "\n";
        script << "END\n";
    }
    script << "plot ";
    index = 0;
    for (const auto& [name, curve] : curves) {
        const bool ours = name.starts_with("kokage");
        script << (index ? ", " : "") << "$data" << index << " with linespoints linewidth " << (ours ? 2 : 1)
               << " dashtype " << (ours ? 1 : 2) << " pointtype " << index % 15 + 1 << " title \"" << name
               << "\" noenhanced";
        ++index;
    }
    return script.str() + "\n";
}

} // namespace

std::optional<double> cpu_seconds_at(const std::vector<TreeRecord>& records, const std::string& generator,
                                     const std::string& species, double leaves) {
    const Curve curve = curve_of(records, generator, species, cpu_of);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i)
        if (curve[i].first <= leaves && leaves <= curve[i + 1].first && curve[i].first < curve[i + 1].first) {
            const double t = std::log(leaves / curve[i].first) / std::log(curve[i + 1].first / curve[i].first);
            return std::exp(std::lerp(std::log(curve[i].second), std::log(curve[i + 1].second), t));
        }
    return {};
}

std::string growth_figures(const std::vector<TreeRecord>& records) {
    std::string text = markdown_row({"figure", "measured", "target", ""}) +
                       markdown_row({"---", "---:", "---:", "---"}) +
                       judged_row(records, "skeleton and leaves, 100,000 leaves", kSkeletonAndLeavesTarget,
                                  &TreeRecord::skeleton_and_leaves_cpu_seconds) +
                       judged_row(records, "bark, 100,000 leaves", kBarkTarget, &TreeRecord::bark_cpu_seconds);
    for (const char* peer : {"ez-tree", "Sapling"})
        text += ratio_row(records, peer);
    return text;
}

std::string growth_table(const std::vector<TreeRecord>& records) {
    std::string text = markdown_row({"generator", "species", "leaves", "triangles", "CPU s",
                                     "skeleton and leaves CPU s", "bark CPU s", "MB"}) +
                       markdown_row(std::vector<std::string>(8, "---"));
    for (const TreeRecord& r : records)
        text += markdown_row({r.generator, r.species, count_text(r.leaves), count_text(r.triangles),
                              three_digits(r.cpu_seconds), three_digits(r.skeleton_and_leaves_cpu_seconds),
                              three_digits(r.bark_cpu_seconds), three_digits(double(r.bytes), 1e-6)});
    return text;
}

std::string plot_trees(const std::vector<TreeRecord>& records, const std::filesystem::path& folder) {
    if (!has_gnuplot())
        return kNoGnuplot;
    const auto megabytes = [](const TreeRecord& record) { return double(record.bytes) * 1e-6; };
    for (const auto& [file, what, value] : {std::tuple("trees-time.svg", "CPU seconds", +cpu_of),
                                            std::tuple("trees-memory.svg", "MB of meshes", +megabytes)})
        if (!draw_plot(folder / file, [&](const std::string& svg) { return plot_script(records, what, value, svg); }))
            return std::string("plots skipped: gnuplot failed on ") + file;
    return "trees-time.svg and trees-memory.svg in " + folder.string();
}

} // namespace kokage
