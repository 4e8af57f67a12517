#pragma once
#include <cstddef>
#include <string_view>

namespace kokage {

/// Where long work tells how far it is, and learns whether it should stop. All members may be called from any thread.
/// The base class is silent and never stops: library users need not provide one.
class Progress {
  public:
    virtual ~Progress() = default;
    /// A stage of `total` steps begins ("tracing paths", 60000).
    virtual void begin(std::string_view /*stage*/, std::size_t /*total*/) {}
    virtual void advance(std::size_t /*steps*/) {}
    /// True once the user has asked to stop: long loops then throw Stopped.
    virtual bool stop_requested() const { return false; }
    /// Throws Stopped if the user asked to stop.
    void throw_if_stopped() const;
};

/// A Progress that says nothing.
Progress& silent_progress();

} // namespace kokage
