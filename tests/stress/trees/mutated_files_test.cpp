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

/// Where in a file damage is of interest: the JSON and header of a .glb take most of it.
std::size_t interesting_range(const std::string& bytes, int number) {
    if (bytes.starts_with("glTF") && number % 4 != 3)
        return 20 + *reinterpret_cast<const std::uint32_t*>(bytes.data() + 12);
    return bytes.size();
}

TEST(MutatedFiles, ChangedBytesInEveryKind) {
    Outcome outcome;
    std::uint64_t stream = 0;
    for (const FileKind& kind : kinds_and_ours()) {
        TemporaryFolder folder;
        write_files(kind, folder.path());
        for (const auto& [name, original] : kind.files) {
            Random random(7, ++stream);
            for (int i = 0; i < cases(60); ++i) {
                std::string bytes = original;
                for (std::uint32_t change = 0; change <= random.below(4); ++change)
                    bytes[random.below(std::uint32_t(interesting_range(bytes, i)))] = char(random.below(256));
                write_bytes(folder / name, bytes);
                read_mutant(folder / kind.main, outcome, kind.kind + ", " + name + ", case " + std::to_string(i));
            }
            write_bytes(folder / name, original);
        }
    }
    EXPECT_GT(outcome.loaded, 20);
    EXPECT_GT(outcome.refused, 20);
    std::printf("%d changed files: %d loaded, %d refused\n", outcome.loaded + outcome.refused, outcome.loaded,
                outcome.refused);
}

/// The bytes behind the base64 of a glTF's first buffer, changed in place: the JSON stays whole, so that damage gets as
/// far as the decoders.
TEST(MutatedFiles, ChangedBinariesOfEveryKind) {
    Outcome outcome;
    std::uint64_t stream = 100;
    for (const FileKind& kind : kinds_and_ours()) {
        if (kind.main == "tree.obj")
            continue;
        TemporaryFolder folder;
        write_files(kind, folder.path());
        const std::string& original = kind.files.at(kind.main);
        const std::string marker = "base64,";
        std::size_t begin = original.find(marker), end = begin;
        if (begin == std::string::npos) {
            begin = original.size() * 3 / 4; // a .glb's binary chunk comes last
            end = original.size();
        } else {
            begin += marker.size();
            end = original.find('"', begin);
        }
        Random random(8, ++stream);
        const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (int i = 0; i < cases(100); ++i) {
            std::string bytes = original;
            for (std::uint32_t change = 0; change <= random.below(6); ++change) {
                const std::size_t at = begin + random.below(std::uint32_t(end - begin));
                bytes[at] = kind.main.ends_with(".glb") ? char(random.below(256)) : digits[random.below(64)];
            }
            write_bytes(folder / kind.main, bytes);
            read_mutant(folder / kind.main, outcome, kind.kind + ", binary, case " + std::to_string(i));
        }
    }
    EXPECT_GT(outcome.loaded, 20);
    EXPECT_GT(outcome.refused, 20);
    std::printf("%d changed binaries: %d loaded, %d refused\n", outcome.loaded + outcome.refused, outcome.loaded,
                outcome.refused);
}

TEST(MutatedFiles, CutOffFilesOfEveryKind) {
    Outcome outcome;
    std::uint64_t stream = 200;
    for (const FileKind& kind : kinds_and_ours()) {
        TemporaryFolder folder;
        write_files(kind, folder.path());
        const std::string& original = kind.files.at(kind.main);
        Random random(9, ++stream);
        for (int i = 0; i < cases(25); ++i) {
            write_bytes(folder / kind.main,
                        original.substr(0, i < 10 ? std::size_t(i) : random.below(std::uint32_t(original.size()))));
            read_mutant(folder / kind.main, outcome, kind.kind + ", cut off, case " + std::to_string(i));
        }
    }
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

TEST(MutatedFiles, ReplacedNumbersInEveryKind) {
    const std::vector<nlohmann::json> values = {
        0,     -1,   1,      2,      3, 255, 65536, 2147483647, -2147483648ll, 4294967295u, 9007199254740993u,
        1e300, -0.5, "text", nullptr};
    Outcome outcome;
    std::uint64_t stream = 300;
    for (const FileKind& kind : kinds_and_ours()) {
        if (kind.main == "tree.obj")
            continue;
        TemporaryFolder folder;
        write_files(kind, folder.path());
        const std::string& original = kind.files.at(kind.main);
        const bool binary = kind.main.ends_with(".glb");
        const std::size_t length = binary ? *reinterpret_cast<const std::uint32_t*>(original.data() + 12) : 0;
        const nlohmann::json json = nlohmann::json::parse(binary ? original.substr(20, length) : original);
        Random random(10, ++stream);
        for (int i = 0; i < cases(60); ++i) {
            nlohmann::json changed = json;
            std::vector<nlohmann::json*> numbers;
            collect_numbers(changed, numbers);
            *numbers[random.below(std::uint32_t(numbers.size()))] = values[random.below(std::uint32_t(values.size()))];
            std::string bytes = changed.dump();
            if (binary) {
                std::string text = bytes;
                text.resize((text.size() + 3) / 4 * 4, ' ');
                bytes = original.substr(0, 12);
                const std::uint32_t chunk = std::uint32_t(text.size());
                bytes.append(reinterpret_cast<const char*>(&chunk), 4)
                    .append("JSON")
                    .append(text)
                    .append(original.substr(20 + length));
                const std::uint32_t whole = std::uint32_t(bytes.size());
                std::memcpy(bytes.data() + 8, &whole, 4);
            }
            write_bytes(folder / kind.main, bytes);
            read_mutant(folder / kind.main, outcome, kind.kind + ", number, case " + std::to_string(i));
        }
    }
    EXPECT_GT(outcome.loaded, 20);
    EXPECT_GT(outcome.refused, 20);
    std::printf("%d files with a number replaced: %d loaded, %d refused\n", outcome.loaded + outcome.refused,
                outcome.loaded, outcome.refused);
}

/// Words of an OBJ and its MTL swapped, doubled and made into numbers that are too large.
TEST(MutatedFiles, ChangedWordsOfObj) {
    const FileKind kind = tree_as_obj();
    TemporaryFolder folder;
    write_files(kind, folder.path());
    const std::vector<std::string> words = {
        "f",   "v",  "usemtl", "mtllib", "-1/-1/-1", "99999999999", "-99999", "1//",    "///",   "1e400",
        "nan", "\\", "g",      "\n",     "map_Kd",   "-s",          "newmtl", "\n\n\n", "0/0/0", "d"};
    Outcome outcome;
    for (const std::string name : {"tree.obj", "two words.mtl"}) {
        const std::string& original = kind.files.at(name);
        Random random(11, name.size());
        for (int i = 0; i < cases(200); ++i) {
            std::string text = original;
            for (std::uint32_t change = 0; change <= random.below(3); ++change) {
                const std::size_t at = random.below(std::uint32_t(text.size()));
                const std::size_t begin = text.find_last_of(" \n", at), end = text.find_first_of(" \n", at);
                if (begin == std::string::npos || end == std::string::npos || begin >= end)
                    continue;
                text.replace(begin + 1, end - begin - 1, words[random.below(std::uint32_t(words.size()))]);
            }
            write_bytes(folder / name, text);
            read_mutant(folder / kind.main, outcome, name + ", case " + std::to_string(i));
        }
        write_bytes(folder / name, original);
    }
    EXPECT_GT(outcome.loaded, 10);
    EXPECT_GT(outcome.refused, 10);
}

TEST(MutatedFiles, RealFiles) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    TemporaryFolder folder;
    Outcome outcome;
    for (const char* name : {"kenney_tree_oak_fall.glb", "quaternius_tex_pine_1.glb", "playcanvas_low_poly_tree.glb",
                             "market_low_poly_tree.gltf", "potted_plant_02.glb"}) {
        const std::string original = read_text(*data / "trees" / name);
        Random random(12, std::hash<std::string>()(name));
        for (int i = 0; i < cases(20); ++i) {
            std::string bytes = original;
            for (int change = 0; change < 3; ++change)
                bytes[random.below(i % 2 ? std::uint32_t(bytes.size()) : 2500u)] = char(random.below(256));
            const std::string mutant = std::string("mutant") + std::filesystem::path(name).extension().string();
            write_bytes(folder / mutant, bytes);
            read_mutant(folder / mutant, outcome, std::string(name) + ", case " + std::to_string(i));
        }
    }
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
