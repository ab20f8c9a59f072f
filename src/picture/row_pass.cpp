// SPDX-License-Identifier: Apache-2.0
#include "picture/row_pass.h"

#include <algorithm>
#include <array>
#include <climits>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "picture/batch_queue.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Batch {
    int ybegin = 0;
    int yend = 0;
    std::vector<std::byte> source;
    std::vector<std::byte> result;
};

class Steps {
  public:
    Steps(const RowPass& pass, const RowTonemapper& tonemapper)
        : pass_(pass), tonemapper_(tonemapper) {}

    void run_in_turn() {
        Batch batch;
        while (next(batch)) {
            read(batch);
            tonemap(batch);
            write(batch);
        }
    }

    void run_in_threads() {
        std::array<Batch, 4> batches;  // one in each step, and one to hand over
        BatchQueue<Batch*> free, read_ones, done;
        for (Batch& batch : batches)
            free.push(&batch);
        std::mutex mutex;
        std::exception_ptr error;
        const auto guarded = [&](auto&& step) {
            try {
                step();
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!error) error = std::current_exception();
                for (BatchQueue<Batch*>* queue : {&free, &read_ones, &done})
                    queue->cancel();
            }
        };
        const auto read_batches = [&] {
            while (const std::optional<Batch*> batch = free.pop()) {
                if (!next(**batch)) break;
                read(**batch);
                read_ones.push(*batch);
            }
            read_ones.close();
        };
        const auto write_batches = [&] {
            while (const std::optional<Batch*> batch = done.pop()) {
                write(**batch);
                free.push(*batch);
            }
        };
        std::jthread reader, writer;
        guarded([&] {
            reader = std::jthread([&] { guarded(read_batches); });
            writer = std::jthread([&] { guarded(write_batches); });
            while (const std::optional<Batch*> batch = read_ones.pop()) {
                tonemap(**batch);
                done.push(*batch);
            }
            done.close();
        });
        for (std::jthread* thread : {&reader, &writer}) {
            if (thread->joinable()) thread->join();
        }
        if (error) std::rethrow_exception(error);
    }

  private:
    /// @returns  false when there are no rows left.
    bool next(Batch& batch) {
        const PictureSpec& source = pass_.source;
        if (rows_done_ >= source.height) return false;
        const int step = pass_.step;
        // Batches begin at multiples of the step from the top, in both directions.
        const int count = (source.height + step - 1) / step;
        const int index = rows_done_ / step;
        batch.ybegin = source.y + (pass_.is_bottom_up ? count - 1 - index : index) * step;
        batch.yend = std::min(batch.ybegin + step, source.y + source.height);
        rows_done_ += step;
        return true;
    }

    void read(Batch& batch) const {
        batch.source.resize(pass_.source.scanline_bytes() *
                            static_cast<std::size_t>(batch.yend - batch.ybegin));
        pass_.read(batch.ybegin, batch.yend, batch.source.data());
    }
    void tonemap(Batch& batch) const {
        const int rows = batch.yend - batch.ybegin;
        batch.result.resize(pass_.result.scanline_bytes() * static_cast<std::size_t>(rows));
        tonemapper_.run(pass_.source, batch.source.data(), rows, pass_.result.format,
                        batch.result.data(), static_cast<unsigned>(pass_.nthreads));
    }
    void write(Batch& batch) const { pass_.write(batch.ybegin, batch.yend, batch.result.data()); }

    const RowPass& pass_;
    const RowTonemapper& tonemapper_;
    int rows_done_ = 0;
};

}  // namespace

int rows_of_batch(std::size_t bytes_per_row, int step, int height, std::size_t batch_bytes) {
    constexpr int kLeast = 64;
    step = std::clamp(step, 1, std::max(height, 1));
    const auto rows = static_cast<int>(
        std::min<std::size_t>(batch_bytes / std::max<std::size_t>(bytes_per_row, 1), INT_MAX));
    const int unit = (kLeast + step - 1) / step * step;
    return std::min(std::max(rows / unit, 1) * unit, std::max(height, 1));
}

void RowPass::run(const RowTonemapper& tonemapper) const {
    Steps steps(*this, tonemapper);
    if (nthreads == 1 || source.height <= step) {
        steps.run_in_turn();
    } else {
        steps.run_in_threads();
    }
}

TONEWRIGHT_NAMESPACE_END
