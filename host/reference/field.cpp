#include "host/reference/field.h"

#include "host/reference/chunks.h"
#include "host/reference/contact.h"

namespace forceshade::reference {
namespace {

// Forces are written faster than memory takes them: so few stay in the processor's cache until they are consumed.
constexpr std::size_t kForceBytes = std::size_t(8) << 20;
constexpr std::size_t kColumnBytes = std::size_t(32) << 20; // more than these are made anew for each chunk

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
                    Crew& crew, const ForceRows<T>* forces, SampleBuffers<T>& buffers) {
    const std::size_t blocks = chunk.y_count >= 4 * threads ? 1 : std::min(chunk.z_count, 4 * threads);
    std::vector<std::vector<Column<T>>> columns(threads);
    crew.share_out(chunk.y_count * blocks, [&](std::size_t thread, std::size_t task) {
        const std::size_t block = task % blocks;
        const std::size_t begin = block * chunk.z_count / blocks, end = (block + 1) * chunk.z_count / blocks;
        const std::size_t y = task / blocks;
        if (!forces)
            return evaluate_rows(input, chunk, y, begin, end, columns[thread], buffers);
        for (std::size_t z = begin; z < end; ++z)
            forces->evaluate(input.law, chunk.y_first + y, input.z[chunk.z_first + z],
                             &buffers.force[3 * (z * chunk.y_count + y) * chunk.x_pitch]);
    });
}

} // namespace

template <typename T>
void evaluate_field(const layout::FieldInput<T>& input, const FieldOptions& options,
                    const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    const layout::uint channels = input.law.features.channels;
    const std::size_t row_bytes =
        std::max<std::size_t>(1, input.x.size() * SampleBuffers<T>::bytes_per_sample(channels));
    const bool forces = ForceRows<T>::serve(input.law.features);
    const bool all_y = ForceRows<T>::bytes(input, input.y.size()) <= kColumnBytes;
    const std::size_t chunk_bytes = forces ? std::min(options.chunk_bytes, kForceBytes) : options.chunk_bytes;
    const std::size_t rows = std::max<std::size_t>(1, chunk_bytes / row_bytes);
    const std::size_t y_step = std::min(input.y.size(), rows);
    const std::size_t z_step = y_step < input.y.size() ? 1 : std::min(input.z.size(), rows / y_step);
    const std::size_t threads = threads_for(options.threads);
    Crew crew(threads);
    ForceRows<T> columns;
    if (forces && all_y)
        columns.prepare(input, 0, input.y.size(), crew);
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
            if (forces && !all_y)
                columns.prepare(input, y, chunk.y_count, crew);
            evaluate_chunk(input, chunk, threads, crew, forces ? &columns : nullptr, buffers);
            consume(chunk);
        }
}

template void evaluate_field<float>(const layout::FieldInput<float>&, const FieldOptions&,
                                    const std::function<void(const layout::FieldChunk<float>&)>&);
template void evaluate_field<double>(const layout::FieldInput<double>&, const FieldOptions&,
                                     const std::function<void(const layout::FieldChunk<double>&)>&);

} // namespace forceshade::reference
