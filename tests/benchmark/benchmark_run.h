#pragma once
// What the run of every benchmark keeps and tells while it measures.
#include "tests/benchmark/benchmark_files.h"

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace kokage {

class BenchmarkRun {
  public:
    /// Makes the folder, measures the calibration loop and tells its time.
    BenchmarkRun(const std::filesystem::path& folder, std::ostream& out);

    /// Tells a line (what was skipped, drawn) and keeps it for the page.
    void note(const std::string& line);
    /// Measures something. A failure is noted and counted, so that it does not hide the others' figures; Stopped goes
    /// on.
    void attempt(const std::string& what, const std::function<void()>& measure);
    /// Writes what is known so far (write_benchmark), so that a run that is stopped leaves what it had measured.
    void write(const std::string& name, const std::string& title, const nlohmann::json& records,
               const std::string& figures, const std::string& table) const;

    /// 0, or 1 if something failed.
    int exit_status() const { return failures_ == 0 ? 0 : 1; }

  private:
    std::filesystem::path folder_;
    std::ostream& out_;
    double calibration_ = 0;
    std::vector<std::string> notes_;
    int failures_ = 0;
};

/// Throws InputError that lists the experiments that there are, if one that is asked for is not among them.
void check_experiments(const std::vector<std::string>& asked, const std::vector<std::string>& known);

} // namespace kokage
