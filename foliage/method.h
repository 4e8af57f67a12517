#pragma once
// The four methods of shading behind one interface:  scene -> transport (who sees whom; no light in it) ->
// solve(lighting) -> solution.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "common/services/progress.h"
#include "foliage/solution.h"
#include "trees/tree.h"

#include <memory>
#include <string_view>

namespace kokage {

enum class Method { paper, light_maps, bundles, path_traced };
enum class GatherRule { rule, cosine }; ///< light-maps: eqs 2-3 of [F], or the map convolved with the two-sided cosine

/// "paper", "light-maps", "bundles", "path-traced"; throws InputError that lists them.
Method method_from_name(std::string_view name);
std::string_view method_name(Method method);

struct ShadingOptions {
    Method method = Method::bundles;
    double error = 0.05; ///< asked MRE (accuracy.h); not used by `paper`
    int effort = 0;      ///< 0 = from `error`; else bundles, light-maps: directions, path-traced: paths a leaf side
    int maps = 0;        ///< 0 = the method's default (paper: 15)
    int bands = 7;
    int max_bounces =
        0; ///< scatterings between light and leaf; 0 = until what is missing is small against the asked error
    GatherRule gather = GatherRule::cosine;
    bool merge_weak_lights = true; ///< bundles: lights that together give a fiftieth of the asked error or less
    /// bundles: paths to some leaves check what lines don't show, one radiance a side, where it may be much; if it is
    /// more than `error`, leaves are divided, or paths traced instead. Off, `error` is asked of the lines alone: for
    /// pictures that gather light anew where they look.
    bool check_by_paths = true;
    bool for_hosts = false; ///< also what only hosts read: bent normals, light maps
    std::uint64_t seed = 1;
};

/// A method's view of a scene, ready to be lit again and again. The scene and tree must outlive it.
class Transport {
  public:
    virtual ~Transport() = default;
    /// Lights the scene. Called again with another environment, only what the change needs is computed:
    /// lights that did not move keep their rasters, and nothing about who sees whom is traced again.
    virtual Solution solve(const Environment& environment, Progress& progress) = 0;
    /// Changes reflectance and transmittance (as long as PatchScene::optics) without tracing anything.
    virtual void set_optics(const std::vector<Optics>& optics) = 0;
    virtual std::size_t bytes() const = 0;
};

/// Builds the transport of a method. `tree` gives branching points and which branch bears which leaf.
std::unique_ptr<Transport> make_transport(const PatchScene& scene, const Tree& tree, const ShadingOptions& options,
                                          Progress& progress);

} // namespace kokage
