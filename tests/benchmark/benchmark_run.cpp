#include "tests/benchmark/benchmark_run.h"

#include "common/services/error.h"
#include "tests/benchmark/calibration.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace kokage {

BenchmarkRun::BenchmarkRun(const std::filesystem::path& folder, std::ostream& out) : folder_(folder), out_(out) {
    std::filesystem::create_directories(folder_);
    calibration_ = calibration_seconds();
    out_ << "calibration loop: " << std::fixed << std::setprecision(3) << calibration_ << " CPU-s\n" << std::flush;
}

void BenchmarkRun::note(const std::string& line) {
    notes_.push_back(line);
    out_ << "  " << line << "\n" << std::flush;
}

void BenchmarkRun::attempt(const std::string& what, const std::function<void()>& measure) {
    try {
        measure();
    } catch (const Stopped&) {
        throw;
    } catch (const std::exception& error) {
        ++failures_;
        note("failed: " + what + ": " + error.what());
    }
}

void BenchmarkRun::write(const std::string& name, const std::string& title, const nlohmann::json& records,
                         const std::string& figures, const std::string& table) const {
    write_benchmark(folder_, name, records, {title, calibration_, figures, table, notes_});
}

void check_experiments(const std::vector<std::string>& asked, const std::vector<std::string>& known) {
    for (const std::string& name : asked) {
        if (std::find(known.begin(), known.end(), name) != known.end())
            continue;
        std::string list;
        for (const std::string& one : known)
            list += (list.empty() ? "" : ", ") + one;
        throw InputError("there is no experiment '" + name + "'; there are: " + list);
    }
}

} // namespace kokage
