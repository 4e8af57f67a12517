#include "reflection/maps/image_sequence.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <optional>

namespace kokage {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostDigits = 18; // of a number in 64 bits

struct NumberPlace {
    std::size_t begin, end; ///< of "%04d" in the name
    std::size_t digits;     ///< at least so many, filled with zeros
};

std::optional<NumberPlace> find_number_place(const std::string& name) {
    std::optional<NumberPlace> found;
    for (std::size_t percent = name.find('%'); percent != std::string::npos; percent = name.find('%', percent + 1)) {
        std::size_t end = percent + 1, digits = 0;
        while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])))
            digits = std::min<std::size_t>(digits * 10 + std::size_t(name[end++] - '0'), 1000);
        if (end < name.size() && name[end] == 'd' && digits <= kMostDigits) {
            if (found)
                return std::nullopt;
            found = NumberPlace{percent, end + 1, digits};
        }
    }
    return found;
}

/// The number that a file's name has where the pattern has its place; the same as numbered_name would write it.
std::optional<std::uint64_t> number_in(const std::string& file, const std::string& pattern, const NumberPlace& place) {
    const std::string before = pattern.substr(0, place.begin), after = pattern.substr(place.end);
    if (file.size() <= before.size() + after.size() || !file.starts_with(before) || !file.ends_with(after))
        return std::nullopt;
    std::uint64_t number = 0;
    const char *begin = file.data() + before.size(), *end = file.data() + file.size() - after.size();
    const auto [stop, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || stop != end || numbered_name(pattern, number) != file)
        return std::nullopt;
    return number;
}

std::vector<SequenceImage> images_of_pattern(const fs::path& pattern) {
    const fs::path folder = pattern.parent_path().empty() ? "." : pattern.parent_path();
    const std::string name = pattern.filename().string();
    const std::optional<NumberPlace> place = find_number_place(name);
    std::error_code error;
    if (!place || !fs::is_directory(folder, error))
        throw InputError(place ? "there is no folder '" + folder.string() + "' for images '" + pattern.string() + "'"
                               : "'" + pattern.string() + "': the number's place has to be in the file's name");
    std::vector<SequenceImage> images;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (const auto number = number_in(entry.path().filename().string(), name, *place))
            images.push_back({*number, pattern.parent_path() / entry.path().filename()});
    std::sort(images.begin(), images.end(),
              [](const SequenceImage& a, const SequenceImage& b) { return a.number < b.number; });
    return images;
}

std::vector<SequenceImage> images_of_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string ending = lower_ending(entry.path());
        for (const char* known : {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp"})
            if (ending == known && entry.is_regular_file())
                files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    std::vector<SequenceImage> images;
    for (const fs::path& file : files)
        images.push_back({images.size() + 1, file});
    return images;
}

std::vector<SequenceImage> images_of_list(const fs::path& list) {
    std::ifstream stream(list);
    if (!stream)
        throw InputError("the list '" + list.string() + "' can't be read");
    std::vector<SequenceImage> images;
    for (std::string line; std::getline(stream, line);) {
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
            line.pop_back();
        if (!line.empty() && line.front() != '#')
            images.push_back({images.size() + 1, list.parent_path() / line}); // an absolute name stays itself
    }
    return images;
}

} // namespace

bool has_number_place(const std::string& name) {
    return find_number_place(name).has_value();
}

std::string numbered_name(const std::string& pattern, std::uint64_t number) {
    const std::optional<NumberPlace> place = find_number_place(pattern);
    if (!place)
        return pattern;
    std::string digits = std::to_string(number);
    digits.insert(0, place->digits - std::min(place->digits, digits.size()), '0');
    return pattern.substr(0, place->begin) + digits + pattern.substr(place->end);
}

bool names_a_sequence(const std::string& name) {
    std::error_code error;
    if (fs::is_regular_file(name, error))
        return lower_ending(name) == ".txt";
    return fs::is_directory(name, error) || has_number_place(name);
}

std::vector<SequenceImage> image_sequence(const std::string& name) {
    std::error_code error;
    std::vector<SequenceImage> images = fs::is_directory(name, error)      ? images_of_folder(name)
                                        : fs::is_regular_file(name, error) ? images_of_list(name)
                                                                           : images_of_pattern(name);
    if (images.empty())
        throw InputError("'" + name + "' names no images; give a folder of them, a list (.txt) or a pattern such as " +
                         "frame_%04d.exr");
    return images;
}

} // namespace kokage
