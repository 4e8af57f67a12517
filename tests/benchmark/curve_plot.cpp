#include "tests/benchmark/curve_plot.h"

#include <sstream>

namespace kokage {

std::string curves_script(const Curves& curves, const std::string& settings, const std::string& file,
                          CurveStyle style) {
    std::ostringstream script;
    script << "set terminal svg size 860,520 background 'white'\nset output '" << file
           << "'\nset grid\nset key outside\n"
           << settings;
    std::size_t index = 0;
    for (const auto& [name, points] : curves) {
        script << "$data" << index++ << " << END\n";
        for (const auto& [x, y] : points)
            script << x << " " << y << "\n";
        script << "END\n";
    }
    script << "plot ";
    index = 0;
    for (const auto& [name, points] : curves) {
        script << (index ? ", " : "") << "$data" << index << " with "
               << (style == CurveStyle::lines ? "linespoints linewidth 2" : "points") << " pointtype " << index % 15 + 1
               << " title \"" << name << "\" noenhanced";
        ++index;
    }
    return script.str() + "\n";
}

} // namespace kokage
