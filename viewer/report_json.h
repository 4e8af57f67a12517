#pragma once
// Parts that reports as JSON share.
#include "common/environment/environment.h"
#include "common/services/work_report.h"

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace kokage {

/// What is not finite becomes null.
nlohmann::ordered_json number_json(double value);
nlohmann::ordered_json vector_json(const glm::vec3& value);
/// An object; a name that stands there more than once has a list.
nlohmann::ordered_json pairs_json(const std::vector<std::pair<std::string, std::string>>& list);
nlohmann::ordered_json environment_json(const Environment& environment, const EnvironmentReport& report);
nlohmann::ordered_json stages_json(const WorkReport& report);
nlohmann::ordered_json skips_json(const WorkReport& report);

} // namespace kokage
