#pragma once
// The light that a command works under: sky, constant, gradient or an image, and added lights; the ground.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "trees/tree.h"
#include "viewer/scene/cli_forward.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kokage {

/// What messages call its parts: options, or, of a scene file, places.
struct SurroundingsWords {
    std::string environment = "--environment", sun = "--sun";
    std::string lights; ///< "/lights": a light's place is told; empty: its text
    std::string no_ground = "--no-ground", exposure = "--exposure";
};

struct Surroundings {
    SurroundingsWords words;
    std::string environment = "sky"; ///< sky, constant[:R,G,B], gradient[:9 numbers] or a file
    std::string sun;                 ///< sky: "AZIMUTH,ELEVATION" in degrees; empty = the default place
    std::optional<double> turbidity; ///< sky: haze
    std::vector<std::string> lights; ///< as common/environment/light_description.h reads them
    bool strict = false;             ///< images: refuse bad pixels
    std::optional<bool> ground;      ///< empty: where the environment has no lower half
    std::string ground_albedo;       ///< a colour; empty = dry grass
};

void add_surroundings_options(CLI::App& app, Surroundings& surroundings);
/// The part of them that shapes the light itself: --sun, --turbidity, --light, --strict.
void add_light_options(CLI::App& app, Surroundings& surroundings);

/// Throws InputError, before any work, for values that can't be. `data`: where a file was looked for (data_folder.h).
void check_surroundings(const Surroundings& surroundings, const std::filesystem::path& data = {});

/// True if the environment is read from an image, false if it is made: sky, constant, gradient.
bool is_environment_image(const Surroundings& surroundings);

/// Builds or loads it, lights added. Point lights are placed relative to `origin`
/// (Tree::origin), as all positions of a tree are. `split`: lights are split off images. `turn_degrees`: images are
/// turned about +Y, from +Z towards +X (EnvironmentLoading).
Environment obtain_environment(const Surroundings& surroundings, const glm::dvec3& origin, EnvironmentReport& report,
                               bool split = true, double turn_degrees = 0);

/// The height where the tree stands: where its trunk begins if that is known (bark may reach into the ground), else the
/// lowest bark at the foot of its stems (twigs may hang lower), without wood its lowest point.
float foot_height(const Tree& tree);

/// Takes out the lights that the ground hides from everything above it: distant ones wholly below the horizon, points
/// under the ground. Gives back a sentence for each light that the user added; those found in an image go silently.
std::vector<std::string> drop_hidden_lights(const Surroundings& surroundings, Environment& environment,
                                            const Ground& ground);

/// ", with the lights sun:1,2,3 + point:4,5,6,7 and 3 more": those of the user that are (still) in the environment.
std::string added_lights_text(const Surroundings& surroundings, const Environment& environment);

/// What a user has to know about the night: empty unless the sky's sun is below the horizon.
std::optional<std::string> night_warning(const Surroundings& surroundings);

/// The ground that takes part in the transport, at the foot of the tree; empty if there is none.
std::optional<Ground> obtain_ground(const Surroundings& surroundings, const Environment& environment, const Tree& tree);
/// The same at a height.
std::optional<Ground> obtain_ground(const Surroundings& surroundings, const Environment& environment, float height_m);

} // namespace kokage
