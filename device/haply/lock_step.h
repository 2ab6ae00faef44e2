// Which answer belongs to which command: the service gives exactly one for each, in order, and numbers neither.
#pragma once

#include <cstddef>

namespace forceshade::device {

/// Counts the answers that are owed. As a rule one command is under way at a time. Where its answer does not come in
/// time, one command without force is sent after it, so that a service that comes to itself again finds that as the
/// last one; nothing more goes out until both answers are here. The first of them is then older than what is asked for
/// and is dropped. An answer that nobody owes is dropped too: should it come while one is owed, it is taken for that
/// one (it is a state of the device as good as any), and what comes after it is the one too many.
class LockStep {
public:
    enum class Kind { current, older, unasked };

    std::size_t owed() const { return owed_; }
    void sent() { ++owed_; }
    void reset() { owed_ = 0; }

    Kind answered() {
        if (owed_ == 0)
            return Kind::unasked;
        return --owed_ == 0 ? Kind::current : Kind::older;
    }

private:
    std::size_t owed_ = 0;
};

} // namespace forceshade::device
