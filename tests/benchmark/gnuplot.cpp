#include "tests/benchmark/gnuplot.h"
#include "common/services/output_file.h"

#include <cstdio>
#include <cstdlib>

namespace kokage {

namespace {

bool run_gnuplot(const std::string& script) {
    FILE* pipe = popen("gnuplot 2>/dev/null", "w");
    if (!pipe)
        return false;
    std::fwrite(script.data(), 1, script.size(), pipe);
    return pclose(pipe) == 0;
}

} // namespace

bool has_gnuplot() {
    return std::system("gnuplot --version >/dev/null 2>&1") == 0;
}

bool draw_plot(const std::filesystem::path& path,
               const std::function<std::string(const std::string& file)>& script_for) {
    OutputFile file(path);
    if (!run_gnuplot(script_for(file.temporary_path().string())))
        return false;
    file.commit();
    return true;
}

} // namespace kokage
