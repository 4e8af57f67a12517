#include "foliage/bundles/steps.h"

#include <algorithm>

namespace kokage::bundles {
namespace {

/// What was done more than once is counted together.
void add_up_counts(WorkReport& report) {
    std::vector<WorkReport::Count> counts;
    for (const WorkReport::Count& count : report.counts) {
        const auto same =
            std::find_if(counts.begin(), counts.end(), [&](const auto& other) { return other.name == count.name; });
        if (same == counts.end())
            counts.push_back(count);
        else
            same->value += count.value;
    }
    report.counts = std::move(counts);
}

class Steps : public Transport {
  public:
    Steps(std::vector<StepMaker> makers, Progress& progress) : makers_(std::move(makers)) { make(progress); }

    Solution solve(const Environment& environment, Progress& progress) override {
        WorkReport before;
        for (;;) {
            if (!transport_) // the last call was stopped while a step was made
                make(progress);
            reach_->gave_up = false;
            Solution solution = transport_->solve(environment, progress);
            before.append(solution.report);
            if (!reach_->gave_up) {
                solution.report = std::move(before);
                add_up_counts(solution.report);
                return solution;
            }
            transport_.reset(); // the next step needs its memory
            ++step_;
        }
    }
    void set_optics(const std::vector<Optics>& optics) override {
        if (transport_)
            transport_->set_optics(optics);
        optics_ = optics;
    }
    std::size_t bytes() const override { return transport_ ? transport_->bytes() : 0; }

  private:
    /// Changes nothing if the maker throws.
    void make(Progress& progress) {
        auto reach = std::make_unique<Reach>();
        reach->may_give_up = step_ + 1 < makers_.size();
        std::unique_ptr<Transport> transport = makers_[step_](*reach, progress);
        if (!optics_.empty())
            transport->set_optics(optics_);
        reach_ = std::move(reach);
        transport_ = std::move(transport);
    }

    std::vector<StepMaker> makers_;
    std::size_t step_ = 0;
    std::unique_ptr<Reach> reach_; ///< outlives `transport_`
    std::vector<Optics> optics_;   ///< as set last; empty = the scene's
    std::unique_ptr<Transport> transport_;
};

} // namespace

std::unique_ptr<Transport> make_steps(std::vector<StepMaker> makers, Progress& progress) {
    return std::make_unique<Steps>(std::move(makers), progress);
}

} // namespace kokage::bundles
