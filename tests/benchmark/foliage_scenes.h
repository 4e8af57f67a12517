#pragma once
// The scenes on which methods of shading are compared. Everything that their light depends on is pinned here.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "trees/tree.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

enum class BenchMaterial {
    realistic, ///< rho (.10,.25,.06), tau (.08,.25,.04), bark (.15,.10,.07)
    bright,    ///< rho .5, tau .4, the same bark
    white,     ///< rho .625, tau .375, bark 1: nothing is absorbed
};

enum class BenchLight {
    sky_sun,       ///< analytic sky + sun, ground plane
    sky_sun_relit, ///< the same sun, another sky: what relighting with the lights fixed is judged on
    lamp_lit,      ///< interior_hotel.exr of the data folder, no ground
    one_light,     ///< a dim grey sky and one light, ground plane
    many_lights,   ///< the same sky and irradiance from 64 lights, ground plane
    point_light,   ///< a dim grey sky and a point light close to the crown, ground plane
    furnace,       ///< radiance 1 from everywhere: every side's radiance is 1
};

std::string_view bench_material_name(BenchMaterial material);
std::string_view bench_light_name(BenchLight light);

struct BenchSceneName {
    BenchLight light = BenchLight::sky_sun;
    std::uint32_t leaves = 30000;
    BenchMaterial material = BenchMaterial::realistic;
};
/// "30000-realistic-sky-sun"
std::string to_string(const BenchSceneName& name);

struct BenchScene {
    BenchSceneName name;
    std::shared_ptr<const Tree> tree;
    PatchScene patches;
    std::shared_ptr<const Environment> environment;
    std::vector<double> leaf_areas; ///< m^2, one-sided, of each leaf
};

/// Makes scenes, and keeps crowns and environments that several of them share.
class BenchScenes {
  public:
    /// `data_folder`: where env/interior_hotel.exr lies; empty = there is none.
    explicit BenchScenes(std::filesystem::path data_folder);

    /// Empty if the scene can be made, else why not ("... is not in ...; set KOKAGE_DATA or --data").
    std::string why_not(const BenchSceneName& name) const;
    /// Throws InputError with why_not() if that is not empty.
    BenchScene make(const BenchSceneName& name);

  private:
    std::shared_ptr<const Tree> crown(std::uint32_t leaves);
    std::shared_ptr<const Environment> environment(BenchLight light);

    std::filesystem::path data_folder_;
    std::vector<std::pair<std::uint32_t, std::shared_ptr<const Tree>>> crowns_;
    std::vector<std::pair<BenchLight, std::shared_ptr<const Environment>>> environments_;
};

/// Hash of everything that a scene's light depends on.
std::uint64_t scene_hash(const BenchScene& scene);

} // namespace kokage
