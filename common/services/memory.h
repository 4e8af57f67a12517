#pragma once
#include <cstdint>
#include <filesystem>

namespace kokage {

/// Has freed memory kept for what comes next instead of handed back to the system at once: stages that follow each
/// other use as much again, and pages that the system gives anew cost more than what is computed in them (a seventh of
/// the time of a shading, measured). For programs, not for libraries; does nothing where the C library has no such
/// switch.
void keep_freed_memory();

/// Bytes that this process can still take: the least of what the system has free (with what it can free at once, and
/// swap), what the control groups that the process is in leave of their limits (Linux, versions 1 and 2: containers),
/// and what its own limit of address space leaves. The largest number where nothing of it is known. `root`: where the
/// system's files are looked for; the limit of address space is looked at for "/" alone.
std::uint64_t available_memory_bytes(const std::filesystem::path& root = "/");

/// The most that this process had in memory so far.
std::uint64_t peak_memory_bytes();

} // namespace kokage
