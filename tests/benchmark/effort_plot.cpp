#include "tests/benchmark/effort_plot.h"
#include "tests/benchmark/gnuplot.h"

#include <algorithm>
#include <map>
#include <sstream>

namespace kokage {

namespace {

/// The points of one method and kind of effort, in order of time.
using Curve = std::vector<std::pair<double, double>>;

std::map<std::string, Curve> curves(const std::vector<FoliageRecord>& records) {
    std::map<std::string, Curve> result;
    for (const FoliageRecord& record : records)
        if (record.cpu_seconds > 0 && record.accuracy.mre > 0)
            result[std::string(method_name(record.method)) + " (" + record.effort_kind + ")"].push_back(
                {record.cpu_seconds, 100 * record.accuracy.mre});
    for (auto& [name, curve] : result)
        std::sort(curve.begin(), curve.end());
    return result;
}

std::string scene_of(const FoliageRecord& record) {
    return std::to_string(record.leaves) + "-" + record.material + "-" + record.scene;
}

} // namespace

std::string plot_script(const std::vector<FoliageRecord>& records, const std::string& output_file) {
    std::ostringstream script;
    script << "set terminal svg size 720,480 background 'white'\nset output '" << output_file << "'\n"
           << "set logscale xy\nset grid\nset xlabel 'CPU seconds'\nset ylabel 'mean relative error, %'\n"
           << "set title '" << (records.empty() ? "" : scene_of(records.front())) << "'\n";
    const auto all = curves(records);
    int index = 0;
    for (const auto& [name, curve] : all) {
        script << "$data" << index++ << " << END\n";
        for (const auto& [cpu, error] : curve)
            script << cpu << " " << error << "\n";
        script << "END\n";
    }
    if (!records.empty() && records.front().reference_noise > 0)
        script << "set arrow from graph 0, first " << 500 * records.front().reference_noise << " to graph 1, first "
               << 500 * records.front().reference_noise << " nohead dashtype 2 linecolor 'gray'\n";
    script << "plot ";
    index = 0;
    for (const auto& [name, curve] : all) {
        script << (index ? ", " : "") << "$data" << index << " with linespoints pointtype " << index + 1 << " title '"
               << name << "'";
        ++index;
    }
    script << "\n";
    return script.str();
}

std::string plot_efforts(const std::vector<FoliageRecord>& records, const std::filesystem::path& folder) {
    if (!has_gnuplot())
        return kNoGnuplot;
    std::map<std::string, std::vector<FoliageRecord>> scenes;
    for (const FoliageRecord& record : records)
        scenes[scene_of(record)].push_back(record);
    std::size_t drawn = 0;
    for (const auto& [name, of_scene] : scenes) {
        if (curves(of_scene).empty())
            continue;
        if (!draw_plot(folder / ("foliage-" + name + ".svg"),
                       [&](const std::string& file) { return plot_script(of_scene, file); }))
            return "plots skipped: gnuplot failed on " + name;
        ++drawn;
    }
    return std::to_string(drawn) + " plots in " + folder.string();
}

} // namespace kokage
