#include "viewer/write_json.h"
#include "common/services/output_file.h"

#include <nlohmann/json.hpp>

namespace kokage {

void write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
    write_file(path, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

} // namespace kokage
