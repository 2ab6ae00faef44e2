#include "host/reference/field.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "host/reference/contact.h"

namespace forceshade::reference {
namespace {

template <typename T> struct Buffers {
    std::vector<T> force, depth, proxy, unshaded;
    std::vector<layout::uint> facet;

    Buffers(layout::uint channels, std::size_t samples)
        : force(channels & layout::kChannelForce ? 3 * samples : 0),
          depth(channels & layout::kChannelDepth ? samples : 0),
          proxy(channels & layout::kChannelProxy ? 3 * samples : 0),
          unshaded(channels & layout::kChannelUnshaded ? 3 * samples : 0),
          facet(channels & layout::kChannelFacet ? samples : 0) {}
};

template <typename T> void store(std::vector<T>& buffer, std::size_t sample, const Vector<T>& value) {
    if (buffer.empty())
        return;
    buffer[3 * sample] = value.x;
    buffer[3 * sample + 1] = value.y;
    buffer[3 * sample + 2] = value.z;
}

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
                   std::size_t z_begin, std::size_t z_end, std::vector<Column<T>>& columns, Buffers<T>& buffers) {
    columns.clear();
    layout::uint hint = 0;
    for (std::size_t x = 0; x < chunk.x_count; ++x)
        columns.push_back(column_at(input.law, input.x[x], input.y[chunk.y_first + y]));
    for (std::size_t z = z_begin; z < z_end; ++z)
        for (std::size_t x = 0; x < chunk.x_count; ++x) {
            const Contact<T> contact = contact_of(input.law, columns[x], input.z[chunk.z_first + z], hint);
            const std::size_t sample = (z * chunk.y_count + y) * chunk.x_pitch + x;
            store(buffers.force, sample, contact.force);
            store(buffers.proxy, sample, contact.proxy);
            store(buffers.unshaded, sample, contact.unshaded);
            if (!buffers.depth.empty())
                buffers.depth[sample] = contact.depth;
            if (!buffers.facet.empty())
                buffers.facet[sample] = contact.facet;
        }
}

// Shares the chunk's rows out among threads: whole y where there are enough, else blocks of z.
template <typename T>
void evaluate_chunk(const layout::FieldInput<T>& input, const layout::FieldChunk<T>& chunk, std::size_t threads,
                    Buffers<T>& buffers) {
    const std::size_t blocks = chunk.y_count >= 4 * threads ? 1 : std::min(chunk.z_count, 4 * threads);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        std::vector<Column<T>> columns;
        for (std::size_t task; (task = next++) < chunk.y_count * blocks;) {
            const std::size_t block = task % blocks;
            evaluate_rows(input, chunk, task / blocks, block * chunk.z_count / blocks,
                          (block + 1) * chunk.z_count / blocks, columns, buffers);
        }
    };
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < threads; ++i)
        helpers.emplace_back(work);
    work();
}

std::size_t bytes_per_sample(layout::uint channels, std::size_t real_size) {
    return (channels & layout::kChannelForce ? 3 * real_size : 0) + (channels & layout::kChannelDepth ? real_size : 0) +
           (channels & layout::kChannelFacet ? sizeof(layout::uint) : 0) +
           (channels & layout::kChannelProxy ? 3 * real_size : 0) +
           (channels & layout::kChannelUnshaded ? 3 * real_size : 0);
}

} // namespace

template <typename T>
void evaluate_field(const layout::FieldInput<T>& input, const FieldOptions& options,
                    const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    const layout::uint channels = input.law.features.channels;
    const std::size_t row_bytes = std::max<std::size_t>(1, input.x.size() * bytes_per_sample(channels, sizeof(T)));
    const std::size_t rows = std::max<std::size_t>(1, options.chunk_bytes / row_bytes);
    const std::size_t y_step = std::min(input.y.size(), rows);
    const std::size_t z_step = y_step < input.y.size() ? 1 : std::min(input.z.size(), rows / y_step);
    const std::size_t threads = options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    Buffers<T> buffers(channels, input.x.size() * y_step * z_step);
    for (std::size_t z = 0; z < input.z.size(); z += z_step)
        for (std::size_t y = 0; y < input.y.size(); y += y_step) {
            layout::FieldChunk<T> chunk{};
            chunk.x_count = chunk.x_pitch = input.x.size();
            chunk.y_first = y;
            chunk.y_count = std::min(y_step, input.y.size() - y);
            chunk.z_first = z;
            chunk.z_count = std::min(z_step, input.z.size() - z);
            chunk.force = buffers.force;
            chunk.depth = buffers.depth;
            chunk.facet = buffers.facet;
            chunk.proxy = buffers.proxy;
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
