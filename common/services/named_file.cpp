#include "common/services/named_file.h"

#include "common/services/error.h"

#include <algorithm>
#include <cctype>
#include <fstream>

namespace kokage {
namespace fs = std::filesystem;

std::vector<unsigned char> read_file_bytes(const fs::path& path, std::uint64_t most) {
    std::error_code error;
    if (!fs::is_regular_file(path, error))
        throw InputError(path.string() + (fs::exists(path, error) ? ": not a regular file" : ": no such file"));
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file)
        throw InputError(path.string() + ": cannot be opened for reading");
    const std::streamoff size = file.tellg();
    if (size > 0 && std::uint64_t(size) > most)
        throw InputError(path.string() + ": its " + std::to_string(size) + " bytes are more than the limit of " +
                         std::to_string(most));
    std::vector<unsigned char> bytes(std::size_t(std::max<std::streamoff>(size, 0)));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
        throw InputError(path.string() + ": could not be read to its end");
    return bytes;
}

std::string lower_ending(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return ending;
}

std::string percent_decoded(const std::string& text) {
    const auto digit = [&](std::size_t i) {
        if (i >= text.size() || !std::isxdigit(static_cast<unsigned char>(text[i])))
            return -1;
        const char c = char(std::tolower(static_cast<unsigned char>(text[i])));
        return c <= '9' ? c - '0' : c - 'a' + 10;
    };
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int high = text[i] == '%' ? digit(i + 1) : -1, low = high >= 0 ? digit(i + 2) : -1;
        if (low >= 0 && high * 16 + low != 0) { // a NUL would cut the name short
            result += char(high * 16 + low);
            i += 2;
        } else {
            result += text[i];
        }
    }
    return result;
}

std::string without_controls(std::string text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte < 0x20 || byte == 0x7f)
            text[i] = '?';
        // U+0080 to U+009F control terminals too.
        if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0)
            text.replace(i, 2, "?");
    }
    return text;
}

std::string shown_name(const std::string& name) {
    constexpr std::size_t most = 80;
    if (name.size() <= most)
        return without_controls(name);
    std::size_t end = most; // not within a character of UTF-8
    while (end > most - 4 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80)
        --end;
    return without_controls(name.substr(0, end)) + "...";
}

namespace {

/// "http:", "file:", but also a drive's letter.
bool has_scheme(const std::string& name) {
    const std::size_t colon = name.find(':');
    return colon != std::string::npos && colon > 0 && name.find_first_of("/\\") > colon &&
           std::all_of(name.begin(), name.begin() + std::ptrdiff_t(colon),
                       [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.'; });
}

/// True if following the name from its folder never climbs out of it.
bool stays_inside(const fs::path& name) {
    int depth = 0;
    for (const fs::path& step : name) {
        if (step == "..")
            --depth;
        else if (!step.empty() && step != ".")
            ++depth;
        if (depth < 0)
            return false;
    }
    return true;
}

} // namespace

namespace {

enum class Fault { none, no_name, absolute, outside, missing };

fs::path search(const fs::path& folder, const std::string& name, NameReach reach, Fault& fault) {
    fault = Fault::no_name;
    if (name.empty() || name.find('\0') != std::string::npos)
        return {};
    std::string slashes = name;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    fault = Fault::missing;
    for (const std::string& tried : {percent_decoded(name), name, percent_decoded(slashes)}) {
        if (has_scheme(tried) || fs::path(tried).is_absolute()) {
            fault = Fault::absolute;
            return {};
        }
        if (reach == NameReach::own_folder && !stays_inside(tried)) {
            fault = Fault::outside;
            continue;
        }
        std::error_code ignored;
        const fs::path path = folder / tried;
        if (fs::is_regular_file(path, ignored)) {
            fault = Fault::none;
            return path;
        }
    }
    return {};
}

} // namespace

fs::path look_for_named_file(const fs::path& folder, const std::string& name, NameReach reach) {
    Fault ignored;
    return search(folder, name, reach, ignored);
}

fs::path find_named_file(const fs::path& folder, const std::string& name, NameReach reach, const std::string& owner) {
    Fault fault;
    const fs::path path = search(folder, name, reach, fault);
    if (fault == Fault::none)
        return path;
    throw InputError(
        owner + ": names the file '" + shown_name(fault == Fault::missing ? percent_decoded(name) : name) + "'" +
        (fault == Fault::no_name ? ", which is no name"
         : fault == Fault::absolute
             ? ", which is not a name relative to its own folder: put that file beside it and name it so"
         : fault == Fault::outside ? ", which lies outside of its folder: put that file beside it and name it so"
                                   : ", which is not there: put it beside the file"));
}

} // namespace kokage
