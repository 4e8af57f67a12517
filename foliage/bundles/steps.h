#pragma once
// One way after another to reach an asked error: whole leaves, leaves in parts, paths.
#include "foliage/method.h"

#include <functional>

namespace kokage::bundles {

/// What a transport and the one that holds it tell each other.
struct Reach {
    bool may_give_up = false; ///< there is another way
    bool gave_up = false;     ///< no effort would reach the error: the solution is not complete
};

/// Makes one way's transport. `reach` outlives it.
using StepMaker = std::function<std::unique_ptr<Transport>(Reach& reach, Progress& progress)>;

/// Solves by the first step that reaches the error, and stays with it. Later steps are not made before they are needed.
std::unique_ptr<Transport> make_steps(std::vector<StepMaker> makers, Progress& progress);

} // namespace kokage::bundles
