#include "common/services/output_file.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>

namespace kokage {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
    throw InputError("cannot write '" + path.string() + "': " + why);
}

/// A name that no other process or thread uses, hidden, with the extension kept: image libraries choose the format by
/// it.
fs::path unused_name_beside(const fs::path& target) {
    static std::atomic<std::uint64_t> counter{0};
    const std::uint64_t key = hash64((std::uint64_t(::getpid()) << 32) + counter++);
    // The stem is cut, so that a long file name with our suffix still fits into the 255 bytes of a name.
    return target.parent_path() / ("." + target.stem().string().substr(0, 100) + ".partial-" + std::to_string(key) +
                                   target.extension().string());
}

/// Follows symbolic links to where the data will be, even if nothing is there yet.
fs::path resolve(fs::path path) {
    for (int links = 0; fs::is_symlink(path); ++links) {
        if (links == 40)
            fail(path, "too many symbolic links");
        const fs::path to = fs::read_symlink(path);
        path = to.is_absolute() ? to : path.parent_path() / to;
    }
    return path;
}

} // namespace

OutputFile::OutputFile(const fs::path& path) : path_(path) {
    std::error_code ignored;
    if (path.empty() || !path.has_filename())
        fail(path, "it names no file; give a file name");
    target_ = resolve(path);
    if (fs::is_directory(target_, ignored))
        fail(path, "it is a folder; give a file name");
    copy_to_device_ = fs::exists(target_, ignored) && !fs::is_regular_file(target_, ignored);
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored))
        fail(path, "there is no folder '" + folder.string() + "'; make it first");
    // O_EXCL: never through a link that someone else put there. Mode 0666 lets the user's umask decide, as for any new
    // file.
    for (int attempt = 0;; ++attempt) {
        temporary_path_ =
            unused_name_beside(copy_to_device_ ? fs::temp_directory_path() / target_.filename() : target_);
        const int descriptor = ::open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) {
            ::close(descriptor);
            break;
        }
        if (errno != EEXIST || attempt == 100)
            fail(path, std::strerror(errno));
    }
    if (!copy_to_device_ && fs::exists(target_, ignored)) {
        if (::access(target_.c_str(), W_OK) != 0) {
            fs::remove(temporary_path_, ignored);
            fail(path, "it exists and is read-only");
        }
        fs::permissions(temporary_path_, fs::status(target_, ignored).permissions(), ignored);
    }
}

OutputFile::~OutputFile() {
    if (committed_)
        return;
    stream_.close();
    std::error_code ignored;
    fs::remove(temporary_path_, ignored);
}

std::ostream& OutputFile::stream() {
    if (!stream_.is_open())
        stream_.open(temporary_path_, std::ios::binary);
    return stream_;
}

void OutputFile::write(std::span<const std::byte> bytes) {
    stream().write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

void OutputFile::write(std::string_view text) {
    stream().write(text.data(), std::streamsize(text.size()));
}

void OutputFile::commit() {
    if (stream_.is_open()) {
        const bool good = stream_.good();
        stream_.close();
        if (!good || stream_.fail())
            fail(path_, "writing failed; is the disk full?");
    }
    if (copy_to_device_) {
        std::ifstream from(temporary_path_, std::ios::binary);
        std::ofstream to(target_, std::ios::binary | std::ios::app);
        if (from.peek() != std::ifstream::traits_type::eof())
            to << from.rdbuf();
        to.close();
        if (!to)
            fail(path_, "writing failed");
        std::error_code ignored;
        fs::remove(temporary_path_, ignored);
    } else {
        std::error_code error;
        fs::rename(temporary_path_, target_, error);
        if (error)
            fail(path_, error.message());
    }
    committed_ = true;
}

void write_file(const fs::path& path, std::string_view contents) {
    OutputFile file(path);
    file.write(contents);
    file.commit();
}

void write_file(const fs::path& path, std::span<const unsigned char> bytes) {
    OutputFile file(path);
    file.write(std::as_bytes(bytes));
    file.commit();
}

} // namespace kokage
