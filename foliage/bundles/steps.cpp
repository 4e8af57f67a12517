#include "foliage/bundles/steps.h"

namespace kokage::bundles {
namespace {

class Steps : public Transport {
  public:
    Steps(std::vector<StepMaker> makers, Progress& progress) : makers_(std::move(makers)) { make(progress); }

    Solution solve(const Environment& environment, Progress& progress) override {
        WorkReport before;
        for (;;) {
            Solution solution = transport_->solve(environment, progress);
            if (!reach_.gave_up) {
                before.append(solution.report);
                solution.report = std::move(before);
                return solution;
            }
            before.stages.insert(before.stages.end(), solution.report.stages.begin(), solution.report.stages.end());
            ++step_;
            make(progress);
        }
    }
    void set_optics(const std::vector<Optics>& optics) override {
        optics_ = optics;
        transport_->set_optics(optics);
    }
    std::size_t bytes() const override { return transport_->bytes(); }

  private:
    void make(Progress& progress) {
        transport_.reset();
        reach_ = {};
        reach_.may_give_up = step_ + 1 < makers_.size();
        transport_ = makers_[step_](reach_, progress);
        if (!optics_.empty())
            transport_->set_optics(optics_);
    }

    std::vector<StepMaker> makers_;
    std::size_t step_ = 0;
    Reach reach_;
    std::vector<Optics> optics_; ///< as set last; empty = the scene's
    std::unique_ptr<Transport> transport_;
};

} // namespace

std::unique_ptr<Transport> make_steps(std::vector<StepMaker> makers, Progress& progress) {
    return std::make_unique<Steps>(std::move(makers), progress);
}

} // namespace kokage::bundles
