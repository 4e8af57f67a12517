#include "viewer/print_file.h"
#include "viewer/scene/values.h"

#include <cstdio>

namespace kokage {

void print_file(const std::filesystem::path& file) {
    if (!file.empty())
        std::printf("%s (%s)\n", std::filesystem::absolute(file).lexically_normal().c_str(),
                    bytes_text(double(std::filesystem::file_size(file))).c_str());
}

} // namespace kokage
