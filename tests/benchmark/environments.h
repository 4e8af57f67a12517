#pragma once
#include "common/environment/environment.h"
#include "tests/benchmark/foliage_scenes.h"

#include <filesystem>

namespace kokage {

/// The surroundings of the benchmark's scenes. Throws InputError if a file is missing or can't be read.
Environment make_bench_environment(BenchLight light, const std::filesystem::path& data_folder);

/// Where the lamp-lit scenes' image lies in a data folder.
std::filesystem::path lamp_lit_file(const std::filesystem::path& data_folder);

/// Another sky of the same lights: turned by a quarter and tinted.
Environment with_another_sky(const Environment& environment);

} // namespace kokage
