// Damaged files of every kind: bytes changed, cut off, numbers replaced. Each either loads as a tree that holds
// together or gives one line, within five seconds.
//
// KOKAGE_MUTANTS (default 1) multiplies the number of cases; `.ci/run` takes a fraction under AddressSanitizer.
#include "common/services/error.h"
#include "tests/support/program_run.h"
#include "tests/support/tree_file_kinds.h"
#include "tests/support/tree_files.h"
#include "trees/patches.h"
#include "trees/read_tree.h"

#include <algorithm>
#include <ctime>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

int cases(int count) {
    const char* factor = std::getenv("KOKAGE_MUTANTS");
    return std::max(1, int(double(count) * (factor && *factor ? std::atof(factor) : 1.0)));
}

struct Outcome {
    int loaded = 0, refused = 0;
};

/// Some are whole enough to be read, some are not: else the damage would be none, or too much.
void expect_both(const Outcome& outcome, int least, const char* what) {
    EXPECT_GT(outcome.loaded, least);
    EXPECT_GT(outcome.refused, least);
    std::printf("%d %s: %d loaded, %d refused\n", outcome.loaded + outcome.refused, what, outcome.loaded,
                outcome.refused);
}

void read_mutant(const std::filesystem::path& path, Outcome& outcome, const std::string& which) {
    const std::clock_t start = std::clock(); // of the processor: a busy machine may stop us for seconds
    try {
        const Tree tree = read_tree(path);
        validate(make_patches(tree));
        ++outcome.loaded;
    } catch (const InputError& error) {
        ++outcome.refused;
        const std::string what = error.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << which << ": " << what;
        EXPECT_FALSE(what.empty()) << which;
        EXPECT_EQ(what.find("exception"), std::string::npos) << which << ": " << what;
    } catch (const std::exception& error) {
        ADD_FAILURE() << which << ": not an InputError: " << error.what();
    }
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    EXPECT_LT(seconds, 5) << which;
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// A tree of ours as a .glb, small enough to be read a thousand times.
FileKind our_file(bool shaded) {
    TemporaryFolder folder;
    const Tree oak = small_oak(12);
    const ShadedAttributes light = random_light(oak);
    write_tree(folder / "original.glb", oak, shaded ? &light : nullptr);
    return {shaded ? "ours, shaded" : "ours", "tree.glb", {{"tree.glb", read_text(folder / "original.glb")}}};
}

std::vector<FileKind> kinds_and_ours() {
    std::vector<FileKind> kinds = all_file_kinds();
    kinds.push_back(our_file(false));
    kinds.push_back(our_file(true));
    return kinds;
}

/// Reads a tree `count` times with one of its files damaged: damage(original, random, i) gives that file's bytes.
template <class Damage>
void read_mutants(const FileKind& kind, const std::string& name, int count, Random random, const char* what,
                  Outcome& outcome, Damage&& damage) {
    TemporaryFolder folder;
    write_files(kind, folder.path());
    const std::string& original = kind.files.at(name);
    for (int i = 0; i < count; ++i) {
        write_bytes(folder / name, damage(original, random, i));
        read_mutant(folder / kind.main, outcome, kind.kind + ", " + name + ", " + what + ", case " + std::to_string(i));
    }
}

bool is_binary(const FileKind& kind) {
    return kind.main.ends_with(".glb");
}

std::size_t json_length(const std::string& glb) {
    return *reinterpret_cast<const std::uint32_t*>(glb.data() + 12);
}

/// Where in a file damage is of interest: the JSON and header of a .glb take most of it.
std::size_t interesting_range(const std::string& bytes, int number) {
    return bytes.starts_with("glTF") && number % 4 != 3 ? 20 + json_length(bytes) : bytes.size();
}

TEST(MutatedFiles, ChangedBytesInEveryKind) {
    Outcome outcome;
    std::uint64_t stream = 0;
    for (const FileKind& kind : kinds_and_ours())
        for (const auto& [name, original] : kind.files)
            read_mutants(kind, name, cases(60), Random(7, ++stream), "bytes", outcome,
                         [](std::string bytes, Random& random, int i) {
                             for (std::uint32_t change = 0; change <= random.below(4); ++change)
                                 bytes[random.below(std::uint32_t(interesting_range(bytes, i)))] =
                                     char(random.below(256));
                             return bytes;
                         });
    expect_both(outcome, 20, "changed files");
}

/// Where a glTF's binaries lie in its main file: behind the base64 of its first buffer, or in the last chunk of a .glb.
std::pair<std::size_t, std::size_t> binary_range(const FileKind& kind) {
    const std::string& original = kind.files.at(kind.main);
    const std::string marker = "base64,";
    const std::size_t begin = original.find(marker);
    if (begin == std::string::npos)
        return {original.size() * 3 / 4, original.size()};
    return {begin + marker.size(), original.find('"', begin + marker.size())};
}

/// Binaries are changed in place: the JSON stays whole, so that damage gets as far as the decoders.
TEST(MutatedFiles, ChangedBinariesOfEveryKind) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    Outcome outcome;
    std::uint64_t stream = 100;
    for (const FileKind& kind : kinds_and_ours()) {
        if (kind.main == "tree.obj")
            continue;
        const auto [begin, end] = binary_range(kind);
        read_mutants(kind, kind.main, cases(100), Random(8, ++stream), "binary", outcome,
                     [&, first = begin, count = std::uint32_t(end - begin)](std::string bytes, Random& random, int) {
                         for (std::uint32_t change = 0; change <= random.below(6); ++change) {
                             const std::size_t at = first + random.below(count);
                             bytes[at] = is_binary(kind) ? char(random.below(256)) : digits[random.below(64)];
                         }
                         return bytes;
                     });
    }
    expect_both(outcome, 20, "changed binaries");
}

TEST(MutatedFiles, CutOffFilesOfEveryKind) {
    Outcome outcome;
    std::uint64_t stream = 200;
    for (const FileKind& kind : kinds_and_ours())
        read_mutants(kind, kind.main, cases(25), Random(9, ++stream), "cut off", outcome,
                     [](const std::string& original, Random& random, int i) {
                         return original.substr(0,
                                                i < 10 ? std::size_t(i) : random.below(std::uint32_t(original.size())));
                     });
    EXPECT_GT(outcome.refused, outcome.loaded) << "an OBJ that is cut off between faces is whole";
}

/// Every number of a JSON value, wherever it stands.
void collect_numbers(nlohmann::json& json, std::vector<nlohmann::json*>& numbers) {
    if (json.is_number())
        numbers.push_back(&json);
    else if (json.is_structured())
        for (nlohmann::json& child : json)
            collect_numbers(child, numbers);
}

/// A .glb with another JSON.
std::string with_json(const std::string& glb, std::string text) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint32_t chunk = std::uint32_t(text.size());
    std::string bytes = glb.substr(0, 12);
    bytes.append(reinterpret_cast<const char*>(&chunk), 4)
        .append("JSON")
        .append(text)
        .append(glb.substr(20 + json_length(glb)));
    const std::uint32_t whole = std::uint32_t(bytes.size());
    std::memcpy(bytes.data() + 8, &whole, 4);
    return bytes;
}

TEST(MutatedFiles, ReplacedNumbersInEveryKind) {
    const std::vector<nlohmann::json> values = {
        0,     -1,   1,      2,      3, 255, 65536, 2147483647, -2147483648ll, 4294967295u, 9007199254740993u,
        1e300, -0.5, "text", nullptr};
    Outcome outcome;
    std::uint64_t stream = 300;
    for (const FileKind& kind : kinds_and_ours()) {
        if (kind.main == "tree.obj")
            continue;
        const std::string& main = kind.files.at(kind.main);
        const nlohmann::json json = nlohmann::json::parse(is_binary(kind) ? main.substr(20, json_length(main)) : main);
        read_mutants(kind, kind.main, cases(60), Random(10, ++stream), "number", outcome,
                     [&](const std::string& original, Random& random, int) {
                         nlohmann::json changed = json;
                         std::vector<nlohmann::json*> numbers;
                         collect_numbers(changed, numbers);
                         nlohmann::json& number = *numbers[random.below(std::uint32_t(numbers.size()))];
                         number = values[random.below(std::uint32_t(values.size()))];
                         return is_binary(kind) ? with_json(original, changed.dump()) : changed.dump();
                     });
    }
    expect_both(outcome, 20, "files with a number replaced");
}

/// Words of an OBJ and its MTL swapped, doubled and made into numbers that are too large.
TEST(MutatedFiles, ChangedWordsOfObj) {
    const FileKind kind = tree_as_obj();
    const std::vector<std::string> words = {
        "f",   "v",  "usemtl", "mtllib", "-1/-1/-1", "99999999999", "-99999", "1//",    "///",   "1e400",
        "nan", "\\", "g",      "\n",     "map_Kd",   "-s",          "newmtl", "\n\n\n", "0/0/0", "d"};
    Outcome outcome;
    for (const std::string name : {"tree.obj", "two words.mtl"})
        read_mutants(kind, name, cases(200), Random(11, name.size()), "words", outcome,
                     [&](std::string text, Random& random, int) {
                         for (std::uint32_t change = 0; change <= random.below(3); ++change) {
                             const std::size_t at = random.below(std::uint32_t(text.size()));
                             const std::size_t begin = text.find_last_of(" \n", at),
                                               end = text.find_first_of(" \n", at);
                             if (begin == std::string::npos || end == std::string::npos || begin >= end)
                                 continue;
                             text.replace(begin + 1, end - begin - 1, words[random.below(std::uint32_t(words.size()))]);
                         }
                         return text;
                     });
    expect_both(outcome, 10, "files with other words");
}

TEST(MutatedFiles, RealFiles) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    Outcome outcome;
    for (const std::string name : {"kenney_tree_oak_fall.glb", "quaternius_tex_pine_1.glb",
                                   "playcanvas_low_poly_tree.glb", "market_low_poly_tree.gltf", "potted_plant_02.glb"})
        read_mutants({"real", name, {{name, read_text(*data / "trees" / name)}}}, name, cases(20),
                     Random(12, std::hash<std::string>()(name)), "bytes", outcome,
                     [](std::string bytes, Random& random, int i) {
                         for (int change = 0; change < 3; ++change)
                             bytes[random.below(i % 2 ? std::uint32_t(bytes.size()) : 2500u)] = char(random.below(256));
                         return bytes;
                     });
    EXPECT_GT(outcome.loaded + outcome.refused, 0);
}

/// The program itself: exit status 2, one line, and no file.
TEST(MutatedFiles, LeaveNoFileBehind) {
    for (const FileKind& kind : all_file_kinds()) {
        TemporaryFolder folder;
        write_files(kind, folder.path());
        const std::string& original = kind.files.at(kind.main);
        write_bytes(folder / kind.main,
                    kind.kind == "obj" ? original + "f 1 2 99999\n" : original.substr(0, original.size() / 2));
        const std::vector<std::string> before = folder.files();
        const ProgramRun run =
            run_kokage({"shade", kind.main, "--quiet", "-o", "out.glb", "--image", "out.png"}, folder.path());
        EXPECT_EQ(run.status, 2) << kind.kind << ": " << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors)) << kind.kind;
        EXPECT_EQ(folder.files(), before) << kind.kind;
    }
}

} // namespace
} // namespace kokage
