#pragma once
#include <string>
#include <vector>

namespace kokage {

/// Whose bark it is.
enum class BarkKind { oak, beech, birch, maple, willow, aspen, pine, spruce, cypress, cherry };

/// Names of the kinds, in their order.
const std::vector<std::string>& bark_kind_names();

} // namespace kokage
