// Damaged files: bytes changed, cut off, numbers replaced. Each either loads as a tree that holds together or gives one
// line.
#include "common/services/error.h"
#include "tests/support/gltf_text.h"
#include "tests/support/program_run.h"
#include "tests/support/tree_files.h"
#include "trees/patches.h"
#include "trees/read_tree.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

struct Outcome {
    int loaded = 0, refused = 0;
};

void read_mutant(const std::string& bytes, const std::filesystem::path& path, Outcome& outcome) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    try {
        const Tree tree = read_tree(path);
        validate(make_patches(tree));
        ++outcome.loaded;
    } catch (const InputError& error) {
        ++outcome.refused;
        const std::string what = error.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        EXPECT_FALSE(what.empty());
        EXPECT_EQ(what.find("exception"), std::string::npos) << what;
    }
}

/// A tree of ours as a .glb, small enough to be read a thousand times.
std::string small_file(const TemporaryFolder& folder, bool shaded) {
    const Tree oak = small_oak(12);
    const ShadedAttributes light = random_light(oak);
    write_tree(folder / "original.glb", oak, shaded ? &light : nullptr);
    return read_text(folder / "original.glb");
}

TEST(MutatedFiles, ChangedBytes) {
    TemporaryFolder folder;
    Outcome outcome;
    for (const bool shaded : {false, true}) {
        const std::string original = small_file(folder, shaded);
        const std::size_t json_end = 20 + *reinterpret_cast<const std::uint32_t*>(original.data() + 12);
        Random random(7, shaded);
        for (int i = 0; i < 400; ++i) {
            std::string bytes = original;
            // Mostly in the header and JSON, where damage does most.
            const std::size_t range = i % 4 == 3 ? bytes.size() : json_end;
            for (std::uint32_t change = 0; change <= random.below(4); ++change)
                bytes[random.below(std::uint32_t(range))] = char(random.below(256));
            read_mutant(bytes, folder / "mutant.glb", outcome);
        }
    }
    EXPECT_GT(outcome.loaded, 20);
    EXPECT_GT(outcome.refused, 100);
}

TEST(MutatedFiles, CutOff) {
    TemporaryFolder folder;
    const std::string original = small_file(folder, true);
    Outcome outcome;
    Random random(8);
    for (int i = 0; i < 200; ++i)
        read_mutant(original.substr(0, i < 60 ? std::size_t(i) : random.below(std::uint32_t(original.size()))),
                    folder / "mutant.glb", outcome);
    EXPECT_EQ(outcome.loaded, 0);
}

/// Every number of a JSON value, wherever it stands.
void collect_numbers(nlohmann::json& json, std::vector<nlohmann::json*>& numbers) {
    if (json.is_number())
        numbers.push_back(&json);
    else if (json.is_structured())
        for (nlohmann::json& child : json)
            collect_numbers(child, numbers);
}

TEST(MutatedFiles, ReplacedNumbers) {
    TemporaryFolder folder;
    const std::string original = small_file(folder, true);
    const std::size_t length = *reinterpret_cast<const std::uint32_t*>(original.data() + 12);
    const nlohmann::json json = nlohmann::json::parse(original.substr(20, length));
    const std::vector<nlohmann::json> values = {
        0,     -1,   1,      2,      3, 255, 65536, 2147483647, -2147483648ll, 4294967295u, 9007199254740993u,
        1e300, -0.5, "text", nullptr};
    Outcome outcome;
    Random random(9);
    for (int i = 0; i < 600; ++i) {
        nlohmann::json changed = json;
        std::vector<nlohmann::json*> numbers;
        collect_numbers(changed, numbers);
        *numbers[random.below(std::uint32_t(numbers.size()))] = values[random.below(std::uint32_t(values.size()))];
        std::string text = changed.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string bytes = original.substr(0, 12);
        const std::uint32_t chunk = std::uint32_t(text.size());
        bytes.append(reinterpret_cast<const char*>(&chunk), 4)
            .append("JSON")
            .append(text)
            .append(original.substr(20 + length));
        const std::uint32_t whole = std::uint32_t(bytes.size());
        std::memcpy(bytes.data() + 8, &whole, 4);
        read_mutant(bytes, folder / "mutant.glb", outcome);
    }
    EXPECT_GT(outcome.loaded, 50);
    EXPECT_GT(outcome.refused, 50);
}

TEST(MutatedFiles, RealFiles) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    TemporaryFolder folder;
    Outcome outcome;
    for (const char* name : {"kenney_tree_oak_fall.glb", "quaternius_tex_pine_1.glb", "playcanvas_low_poly_tree.glb",
                             "market_low_poly_tree.gltf"}) {
        const std::string original = read_text(*data / "trees" / name);
        Random random(10, std::hash<std::string>()(name));
        for (int i = 0; i < 40; ++i) {
            std::string bytes = original;
            for (int change = 0; change < 3; ++change)
                bytes[random.below(i % 2 ? std::uint32_t(bytes.size()) : 2500u)] = char(random.below(256));
            read_mutant(bytes, folder / (std::string("mutant") + std::filesystem::path(name).extension().string()),
                        outcome);
        }
    }
    EXPECT_GT(outcome.loaded + outcome.refused, 100);
}

} // namespace
} // namespace kokage
