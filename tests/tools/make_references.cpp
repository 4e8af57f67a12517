// Makes the references of the benchmark's scenes: kokage_make_references CACHE_FOLDER PATHS_A_SIDE THREADS [NAME]...
// Stop it whenever you like: it goes on where it was. Copy the finished *.reference files to
// tests/benchmark/references.
#include "common/services/error.h"
#include "tests/benchmark/foliage_benchmark.h"

#include <cstdlib>
#include <iostream>

int main(int count, char** arguments) {
    if (count < 4) {
        std::cerr << "usage: kokage_make_references CACHE_FOLDER PATHS_A_SIDE THREADS [SCENE]...\n";
        return 2;
    }
    kokage::FoliageBenchmarkOptions options;
    options.cache_folder = arguments[1];
    options.reference_paths = std::strtoull(arguments[2], nullptr, 10);
    options.threads = std::atoi(arguments[3]);
    const std::vector<std::string> only(arguments + 4, arguments + count);
    try {
        return kokage::make_foliage_references(options, only, kokage::silent_progress(), std::cout);
    } catch (const kokage::InputError& error) {
        std::cerr << error.what() << "\n";
        return 2;
    }
}
