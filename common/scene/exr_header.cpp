#include "common/scene/exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>

namespace kokage {
namespace {

constexpr std::uint64_t kTableEntry = 8; ///< bytes of a chunk's place in the file's table
constexpr std::size_t kMostName = 255;
constexpr std::uint32_t kMagic = 20000630, kSeveralParts = 1u << 12;

/// Lines of a chunk, by the compression's number: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr std::array<std::uint64_t, 10> kLinesAChunk = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

/// Bytes of a file from a place on: false where it ends before.
using ReadAt = std::function<bool(std::uint64_t place, void* to, std::size_t count)>;

struct Window {
    std::int32_t left, top, right, bottom; ///< inclusive
    std::uint64_t width() const { return std::uint64_t(std::int64_t(right) - left + 1); }
    std::uint64_t height() const { return std::uint64_t(std::int64_t(bottom) - top + 1); }
};

/// One part's attributes, as far as they tell how many chunks it has.
struct Part {
    std::optional<Window> window;
    std::optional<std::array<std::uint32_t, 2>> tile;
    std::uint64_t lines_a_chunk = kLinesAChunk.back(), announced_chunks = 0;

    std::uint64_t chunks() const {
        const auto pieces = [](std::uint64_t length, std::uint64_t piece) { return (length + piece - 1) / piece; };
        const std::uint64_t all = tile ? pieces(window->width(), (*tile)[0]) * pieces(window->height(), (*tile)[1])
                                       : pieces(window->height(), lines_a_chunk);
        return std::max(all, announced_chunks);
    }
};

class HeaderWalk {
  public:
    HeaderWalk(const ReadAt& read, std::uint64_t file_bytes) : read_(read), file_bytes_(file_bytes) {}

    std::string problem() {
        std::uint32_t start[2];
        if (!read_(0, start, sizeof start) || start[0] != kMagic)
            return "";
        place_ = sizeof start;
        std::uint64_t chunks = 0;
        do {
            Part part;
            bool empty = true;
            for (std::string name; read_name(name) && !name.empty(); empty = false)
                if (!read_attribute(name, part))
                    return kDamaged;
            if (is_cut_)
                return kDamaged;
            if (empty)
                break; // the end of several parts
            if (!part.window || part.window->right < part.window->left || part.window->bottom < part.window->top)
                return "its header announces no pixels";
            if (part.tile && ((*part.tile)[0] < 1 || (*part.tile)[1] < 1))
                return kDamaged;
            chunks += std::min(part.chunks(), file_bytes_);
            if (chunks * kTableEntry > file_bytes_)
                return "its header announces " + std::to_string(part.window->width()) + " x " +
                       std::to_string(part.window->height()) + " pixels, more than its " + std::to_string(file_bytes_) +
                       " bytes can hold";
        } while (start[1] & kSeveralParts);
        return "";
    }

  private:
    static constexpr const char* kDamaged = "its header is cut off or damaged";

    /// Up to and with its final NUL.
    bool read_name(std::string& name) {
        std::array<char, kMostName + 1> bytes{};
        const std::uint64_t left = file_bytes_ - std::min(place_, file_bytes_);
        const std::size_t count = std::size_t(std::min<std::uint64_t>(bytes.size(), left));
        const auto end = bytes.begin() + std::ptrdiff_t(count);
        const auto nul = read_(place_, bytes.data(), count) ? std::find(bytes.begin(), end, '\0') : end;
        if (nul == end) {
            is_cut_ = true;
            return false;
        }
        name.assign(bytes.begin(), nul);
        place_ += name.size() + 1;
        return true;
    }

    bool read_attribute(const std::string& name, Part& part) {
        std::string type;
        std::uint32_t size = 0;
        if (!read_name(type) || !read_(place_, &size, sizeof size) || file_bytes_ - place_ - sizeof size < size)
            return false;
        const std::uint64_t at = place_ + sizeof size;
        place_ = at + size;
        const auto value = [&](auto& to) { return size >= sizeof to && read_(at, &to, sizeof to); };
        if (name == "dataWindow")
            return value(part.window.emplace());
        if (name == "tiles")
            return value(part.tile.emplace());
        if (name == "compression") {
            std::uint8_t number = 0;
            if (!value(number))
                return false;
            if (number < kLinesAChunk.size())
                part.lines_a_chunk = kLinesAChunk[number];
        } else if (name == "chunkCount") {
            std::int32_t count = 0;
            if (!value(count) || count < 0)
                return false;
            part.announced_chunks = std::uint64_t(count);
        } else if (type == "preview") {
            std::array<std::uint32_t, 2> preview{};
            return value(preview) && std::uint64_t(preview[0]) * preview[1] * 4 + sizeof preview == size;
        }
        return true;
    }

    const ReadAt& read_;
    std::uint64_t file_bytes_, place_ = 0;
    bool is_cut_ = false;
};

} // namespace

std::string exr_header_problem(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? std::streamoff(file.tellg()) : 0;
    const ReadAt read = [&](std::uint64_t place, void* to, std::size_t count) {
        file.clear();
        file.seekg(std::streamoff(place));
        return bool(file.read(static_cast<char*>(to), std::streamsize(count)));
    };
    return size > 0 ? HeaderWalk(read, std::uint64_t(size)).problem() : "";
}

std::string exr_header_problem(std::span<const std::byte> bytes) {
    const ReadAt read = [&](std::uint64_t place, void* to, std::size_t count) {
        if (place > bytes.size() || count > bytes.size() - place)
            return false;
        std::memcpy(to, bytes.data() + place, count);
        return true;
    };
    return HeaderWalk(read, bytes.size()).problem();
}

} // namespace kokage
