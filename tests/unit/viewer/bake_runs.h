#pragma once
// Runs of `kokage bake` on small images and coarse maps.
#include "common/scene/image_file.h"
#include "reflection/maps/map_file.h"
#include "tests/support/program_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kokage {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

inline Image gradient_image(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 0.2f + 0.6f * float(y + c) / float(height + 2);
    return image;
}

/// A coarse map, quickly; further words are added.
inline Words small_bake(const std::string& environment, Words more) {
    Words words = {"bake", environment, "--smoothness", "0,0.1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// What is in a map of shells.
inline std::vector<std::byte> texels_of(const std::filesystem::path& file) {
    const MapFile map = read_map(file);
    const std::span<const std::byte> texels = std::get<ShellMap>(map.map).texels();
    return {texels.begin(), texels.end()};
}

/// The message of a run that is refused: exit status 2, one line, nothing written.
inline std::string refusal(const Words& words) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(16, 8));
    const ProgramRun run = run_kokage(words, folder.path());
    EXPECT_EQ(run.status, 2) << run.errors;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_EQ(folder.files(), Words({"in.exr"}));
    return run.errors;
}

} // namespace kokage
