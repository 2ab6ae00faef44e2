#include "host/reference/field.h"

#include "host/reference/chunks.h"
#include "host/reference/contact.h"

namespace forceshade::reference {
namespace {

// The law at a sample. What was nearest to a mesh's last sample is a good guess for the next.
template <typename T>
Contact<T> contact_of(const layout::Law<T>& law, const Column<T>& column, T z, layout::uint& hint) noexcept {
    if (law.features.surface == layout::kSurfaceMesh)
        return mesh_contact(law, Vector<T>(column.x, column.y, z), hint);
    return contact_at(law, column, z);
}

// One y, some z of the chunk. The columns are computed once for all of them, as in the kernel.
template <typename T>
void evaluate_rows(const layout::FieldInput<T>& input, const layout::FieldChunk<T>& chunk, std::size_t y,
                   std::size_t z_begin, std::size_t z_end, std::vector<Column<T>>& columns, SampleBuffers<T>& buffers) {
    columns.clear();
    layout::uint hint = 0;
    for (std::size_t x = 0; x < chunk.x_count; ++x)
        columns.push_back(column_at(input.law, input.x[x], input.y[chunk.y_first + y]));
    for (std::size_t z = z_begin; z < z_end; ++z)
        for (std::size_t x = 0; x < chunk.x_count; ++x) {
            const Contact<T> contact = contact_of(input.law, columns[x], input.z[chunk.z_first + z], hint);
            const std::size_t sample = (z * chunk.y_count + y) * chunk.x_pitch + x;
            buffers.store(sample, contact, contact.force);
            SampleBuffers<T>::put(buffers.unshaded, sample, contact.unshaded);
        }
}

// Shares the chunk's rows out among threads: whole y where there are enough, else blocks of z.
template <typename T>
void evaluate_chunk(const layout::FieldInput<T>& input, const layout::FieldChunk<T>& chunk, std::size_t threads,
                    SampleBuffers<T>& buffers) {
    const std::size_t blocks = chunk.y_count >= 4 * threads ? 1 : std::min(chunk.z_count, 4 * threads);
    std::vector<std::vector<Column<T>>> columns(threads);
    share_out(threads, chunk.y_count * blocks, [&](std::size_t thread, std::size_t task) {
        const std::size_t block = task % blocks;
        evaluate_rows(input, chunk, task / blocks, block * chunk.z_count / blocks, (block + 1) * chunk.z_count / blocks,
                      columns[thread], buffers);
    });
}

} // namespace

template <typename T>
void evaluate_field(const layout::FieldInput<T>& input, const FieldOptions& options,
                    const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    const layout::uint channels = input.law.features.channels;
    const std::size_t row_bytes =
        std::max<std::size_t>(1, input.x.size() * SampleBuffers<T>::bytes_per_sample(channels));
    const std::size_t rows = std::max<std::size_t>(1, options.chunk_bytes / row_bytes);
    const std::size_t y_step = std::min(input.y.size(), rows);
    const std::size_t z_step = y_step < input.y.size() ? 1 : std::min(input.z.size(), rows / y_step);
    const std::size_t threads = threads_for(options.threads);
    SampleBuffers<T> buffers;
    buffers.resize(channels, input.x.size() * y_step * z_step);
    for (std::size_t z = 0; z < input.z.size(); z += z_step)
        for (std::size_t y = 0; y < input.y.size(); y += y_step) {
            layout::FieldChunk<T> chunk{};
            chunk.x_count = chunk.x_pitch = input.x.size();
            chunk.y_first = y;
            chunk.y_count = std::min(y_step, input.y.size() - y);
            chunk.z_first = z;
            chunk.z_count = std::min(z_step, input.z.size() - z);
            buffers.set_spans(chunk);
            chunk.unshaded = buffers.unshaded;
            evaluate_chunk(input, chunk, threads, buffers);
            consume(chunk);
        }
}

template void evaluate_field<float>(const layout::FieldInput<float>&, const FieldOptions&,
                                    const std::function<void(const layout::FieldChunk<float>&)>&);
template void evaluate_field<double>(const layout::FieldInput<double>&, const FieldOptions&,
                                     const std::function<void(const layout::FieldChunk<double>&)>&);

} // namespace forceshade::reference
