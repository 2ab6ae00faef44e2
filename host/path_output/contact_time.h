// How long a recorded path was in contact.
#pragma once

namespace forceshade {

/// By the times that the file gives the samples: a sample counts the time until the next one, the last one as much as
/// the one before it. A path of one sample has no time.
class ContactTime {
public:
    /// The next sample, at `time`, s.
    void add(double time, bool touches) {
        if (begun_) {
            share_ = time - time_;
            total_ += touched_ ? share_ : 0;
        }
        begun_ = true;
        time_ = time;
        touched_ = touches;
    }
    /// s.
    double total() const { return total_ + (touched_ ? share_ : 0); }

private:
    bool begun_ = false, touched_ = false;
    double time_ = 0;  /* s: of the last sample */
    double share_ = 0; /* s: of the sample before the last */
    double total_ = 0; /* s: of the samples before the last */
};

} // namespace forceshade
