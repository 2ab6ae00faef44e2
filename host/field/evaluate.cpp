#include "host/field/evaluate.h"

#include "host/output/rows.h"

namespace forceshade {

template <typename T> void Field<T>::append(const layout::FieldChunk<T>& chunk, std::size_t repeats) {
    append_rows(chunk, chunk.force, 3, repeats, force);
    append_rows(chunk, chunk.depth, 1, repeats, depth);
    append_rows(chunk, chunk.proxy, 3, repeats, proxy);
    append_rows(chunk, chunk.unshaded, 3, repeats, unshaded);
    append_rows(chunk, chunk.facet, 1, repeats, facet);
}

template <typename T> Field<T> evaluate(const layout::FieldInput<T>& input, std::size_t repeats, Engine& engine) {
    Field<T> field;
    field.times = engine.evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) { field.append(chunk, repeats); });
    return field;
}

template <typename T> Field<T> evaluate(const PreparedCase& prepared, Engine& engine) {
    const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies);
    const layout::FieldInput<T> input = tables.input();
    return evaluate<T>(input, prepared.one.scene.grid.size[1] / input.y.size(), engine);
}

template struct Field<float>;
template struct Field<double>;
template Field<float> evaluate(const layout::FieldInput<float>&, std::size_t, Engine&);
template Field<double> evaluate(const layout::FieldInput<double>&, std::size_t, Engine&);
template Field<float> evaluate<float>(const PreparedCase&, Engine&);
template Field<double> evaluate<double>(const PreparedCase&, Engine&);

} // namespace forceshade
