#include "tests/benchmark/benchmark_files.h"
#include "common/services/output_file.h"
#include "common/services/parallel.h"

#include <nlohmann/json.hpp>

namespace kokage {

void write_benchmark(const std::filesystem::path& folder, const std::string& name, const nlohmann::json& records,
                     const BenchmarkPage& page) {
    write_file(folder / (name + ".json"), records.dump(1) + "\n");
    std::string text = "# " + page.title + "\n\nCalibration loop: " + std::to_string(page.calibration_cpu_seconds) +
                       " CPU-s. " + std::to_string(thread_count()) + " threads.\n\n" + page.figures + "\n" + page.table;
    for (const std::string& line : page.notes)
        text += "\n- " + line;
    write_file(folder / (name + ".md"), text + "\n");
}

} // namespace kokage
