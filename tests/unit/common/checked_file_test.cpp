#include "common/services/byte_hash.h"
#include "common/services/checked_file.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"

#include <bit>
#include <cstring>
#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr CheckedFileKind kKind{{'K', 'o', 'k', 'a', 'g', 'e', 'T', 'E'}, 3, "test file", "another test"};
constexpr std::uint64_t kIdentity = 0x123456789abcdef0;

/// Arrays of sizes that need padding and that do not, an empty one among them.
struct Arrays {
    std::vector<float> floats{1.5f, -2, 3e30f};
    std::vector<std::uint8_t> bytes{1, 2, 3, 4, 5};
    std::vector<std::uint64_t> none;
    std::vector<double> doubles{0.1, 1e-300};

    void write(const std::filesystem::path& path) const {
        const std::span<const std::byte> all[] = {std::as_bytes(std::span(floats)), std::as_bytes(std::span(bytes)),
                                                  std::as_bytes(std::span(none)), std::as_bytes(std::span(doubles))};
        write_checked_file(path, kKind, kIdentity, all);
    }
};

std::string refusal(const std::filesystem::path& path, const CheckedFileKind& kind = kKind,
                    std::optional<std::uint64_t> identity = kIdentity, std::uint64_t most = 1 << 20) {
    try {
        const CheckedFile file(path, kind, identity, most);
    } catch (const InputError& error) {
        const std::string told = error.what();
        EXPECT_TRUE(told.starts_with("test file '" + path.string() + "': ")) << told;
        return told;
    }
    return "";
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST(CheckedFile, GivesBackWhatWasWritten) {
    const TemporaryFolder folder;
    const Arrays arrays;
    arrays.write(folder / "file");
    const CheckedFile file(folder / "file", kKind, kIdentity);
    EXPECT_EQ(file.arrays(), 4u);
    EXPECT_EQ(file.identity(), kIdentity);
    EXPECT_EQ(file.copied<float>(0), arrays.floats);
    EXPECT_EQ(file.copied<std::uint8_t>(1), arrays.bytes);
    EXPECT_EQ(file.copied<std::uint64_t>(2), arrays.none);
    EXPECT_EQ(file.copied<double>(3), arrays.doubles);
    EXPECT_THROW(file.array<float>(4), InputError);
    EXPECT_THROW(file.array<float>(1), InputError); // 5 bytes
    EXPECT_EQ(CheckedFile(folder / "file", kKind, std::nullopt).identity(), kIdentity);
    // 40 of header, 4 sizes, 12 + 4, 5 + 3, 0 and 16: no other program of ours may read it differently.
    EXPECT_EQ(std::filesystem::file_size(folder / "file"), 40u + 32 + 16 + 8 + 16);
}

TEST(CheckedFile, NoArraysAreAFileToo) {
    const TemporaryFolder folder;
    write_checked_file(folder / "file", kKind, 7, {});
    EXPECT_EQ(CheckedFile(folder / "file", kKind, 7).arrays(), 0u);
}

TEST(CheckedFile, SaysWhatIsWrong) {
    const TemporaryFolder folder;
    Arrays().write(folder / "file");
    const std::string whole = read_text(folder / "file");
    const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    EXPECT_EQ(refusal(folder / "file"), "");
    EXPECT_TRUE(has(refusal(folder / "none"), "can't be read"));
    EXPECT_TRUE(has(refusal(folder.path()), "can't be read"));
    EXPECT_TRUE(has(refusal(folder / "file", kKind, 5), "made for another test"));
    EXPECT_TRUE(has(refusal(folder / "file", kKind, kIdentity, 100), "at most 100"));
    CheckedFileKind other = kKind;
    other.version = 4;
    EXPECT_TRUE(has(refusal(folder / "file", other), "version 3"));
    other.magic[7] = 'X';
    EXPECT_TRUE(has(refusal(folder / "file", other), "no test file"));
    write_bytes(folder / "file", "");
    EXPECT_TRUE(has(refusal(folder / "file"), "no test file"));
    write_bytes(folder / "file", whole + "x");
    EXPECT_TRUE(has(refusal(folder / "file"), "altered"));
}

/// Every place where it may be cut, and every byte that may change.
TEST(CheckedFile, RefusesWhateverWasCutOffOrAltered) {
    const TemporaryFolder folder;
    Arrays().write(folder / "file");
    const std::string whole = read_text(folder / "file");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write_bytes(folder / "file", whole.substr(0, length));
        const std::string told = refusal(folder / "file");
        EXPECT_NE(told.find(length < 40 ? "no test file" : "truncated"), std::string::npos) << length << ": " << told;
    }
    for (std::size_t place = 0; place < whole.size(); ++place) {
        std::string altered = whole;
        altered[place] = char(altered[place] ^ 1 << place % 8);
        write_bytes(folder / "file", altered);
        EXPECT_NE(refusal(folder / "file"), "") << place;
    }
}

/// Headers that announce what no file can hold cost neither memory nor time.
TEST(CheckedFile, TakesNoMemoryForWhatIsNotThere) {
    const TemporaryFolder folder;
    Arrays().write(folder / "file");
    const std::string whole = read_text(folder / "file");
    for (const std::size_t place : {24u, 40u, 48u, 64u})
        for (const std::uint64_t number : {~std::uint64_t(0), ~std::uint64_t(0) - 6, std::uint64_t(1) << 61,
                                           std::uint64_t(1) << 40, std::uint64_t(1000)}) {
            std::string altered = whole;
            std::memcpy(altered.data() + place, &number, 8);
            write_bytes(folder / "file", altered);
            EXPECT_NE(refusal(folder / "file"), "") << place << " " << number;
        }
}

TEST(FileIdentity, DependsOnEveryPieceAndTheirOrder) {
    const auto of = [](auto... values) {
        FileIdentity identity;
        (identity.add_value(values), ...);
        return identity.value();
    };
    EXPECT_EQ(of(1, 2.0), of(1, 2.0));
    EXPECT_NE(of(1, 2), of(2, 1));
    EXPECT_NE(of(1, 2), of(1));
    EXPECT_NE(of(0), of(0, 0));
    EXPECT_NE(of(1.f), of(1));
}

TEST(ByteHash, TellsEveryBitAndEveryLength) {
    Random random(5);
    for (const std::size_t length : {0u, 1u, 7u, 31u, 32u, 33u, 100u}) {
        std::vector<std::byte> bytes(length);
        for (std::byte& byte : bytes)
            byte = std::byte(random.below(256));
        const std::uint64_t hash = byte_hash(bytes);
        EXPECT_EQ(byte_hash(bytes), hash);
        EXPECT_NE(byte_hash(bytes, 1), hash);
        for (std::size_t bit = 0; bit < 8 * length; ++bit) {
            bytes[bit / 8] ^= std::byte(1 << bit % 8);
            EXPECT_NE(byte_hash(bytes), hash) << length << " " << bit;
            bytes[bit / 8] ^= std::byte(1 << bit % 8);
        }
        bytes.push_back(std::byte(0));
        EXPECT_NE(byte_hash(bytes), hash) << length;
    }
}

} // namespace
} // namespace kokage
