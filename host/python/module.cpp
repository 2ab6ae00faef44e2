// The Python module forceshade._native: what needs C++. Its face is forceshade/__init__.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "compute/device.h"
#include "host/error.h"
#include "host/field/engine.h"
#include "host/field/mesh_cache.h"
#include "host/output/kept.h"
#include "host/program.h"
#include "host/python/arrays.h"

namespace forceshade::python {
namespace {

// As the command line's exit codes tell errors apart; each is also what a Python programmer would catch. They live as
// long as the process.
PyObject *any_error, *scene_error, *file_error, *device_error;

PyObject* define_exception(py::module_& module, const char* name, const char* doc, const py::tuple& bases) {
    PyObject* made = PyErr_NewExceptionWithDoc(("forceshade." + std::string(name)).c_str(), doc, bases.ptr(), nullptr);
    if (!made)
        throw py::error_already_set();
    module.add_object(name, py::handle(made));
    return made;
}

void define_exceptions(py::module_& module) {
    const auto type = [](PyObject* object) { return py::reinterpret_borrow<py::object>(object); };
    any_error = define_exception(module, "Error", "What forceshade could not do, in words.",
                                 py::make_tuple(type(PyExc_Exception)));
    const auto both = [&](PyObject* other) { return py::make_tuple(type(any_error), type(other)); };
    scene_error = define_exception(module, "SceneError",
                                   "A scene, or an argument, without a meaning: what, where, and what would be right.",
                                   both(PyExc_ValueError));
    file_error =
        define_exception(module, "FileError", "A file that is missing, damaged or not readable.", both(PyExc_OSError));
    device_error = define_exception(module, "DeviceError", "A Vulkan device that is not there, or failed.",
                                    both(PyExc_RuntimeError));
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const UsageError& error) {
            PyErr_SetString(scene_error, error.what());
        } catch (const IoError& error) {
            PyErr_SetString(file_error, error.what());
        } catch (const Error& error) {
            PyErr_SetString(any_error, error.what());
        } catch (const compute::DeviceError& error) {
            PyErr_SetString(device_error, error.what());
        }
    });
}

EngineOptions engine_options(const PreparedScene& scene, const std::string& engine, const std::string& gpu,
                             unsigned threads) {
    if (engine != "cpu" && engine != "gpu")
        throw UsageError("no engine \"" + engine + "\": there are \"cpu\" and \"gpu\"");
    EngineOptions options;
    options.cpu = engine == "cpu";
    options.threads = threads;
    options.gpu = gpu;
    options.needs_f64 = scene.prepared().one.scene.precision == Precision::f64;
    if (!options.cpu)
        options.cache = default_cache_folder();
    return options;
}

void define(py::module_& module) {
    keep_meshes_in(default_cache_folder());
    define_exceptions(module);
    module.attr("__version__") = version();
    py::class_<PreparedScene, std::shared_ptr<PreparedScene>>(module, "Scene")
        .def(py::init<const std::string&, const std::string&, const std::string&, const std::vector<Override>&,
                      const std::optional<PreparedScene::MeshArrays>&>())
        .def_property_readonly("toml", [](const PreparedScene& scene) { return scene.prepared().scene; })
        .def_property_readonly("warnings", &PreparedScene::warnings)
        .def("field",
             [](const PreparedScene& scene, const std::vector<std::string>& channels, const std::string& engine,
                const std::string& gpu,
                unsigned threads) { return scene.field(channels, engine_options(scene, engine, gpu, threads)); })
        .def("contact", &PreparedScene::contact)
        .def_property_readonly("compares", &PreparedScene::compares)
        .def("compare", &PreparedScene::compare)
        .def("explore", [](const PreparedScene& scene, const std::optional<std::vector<Points>>& paths,
                           const std::string& engine, const std::string& gpu, unsigned threads) {
            return scene.explore(paths, engine_options(scene, engine, gpu, threads));
        });
    py::class_<GodObject>(module, "GodObject")
        .def(py::init([](const std::shared_ptr<PreparedScene>& scene) { return GodObject(scene); }))
        .def("follow", &GodObject::follow)
        .def("reset", &GodObject::reset);
    py::class_<ScoredStrokes>(module, "ScoredStrokes")
        .def(py::init<const PreparedScene&, const std::vector<Points>&, double>())
        .def("oracle", &ScoredStrokes::oracle)
        .def("score", &ScoredStrokes::score);
    module.def("read_scene_text", [](const std::string& file) { return read_scene_text(file).text; });
    module.def("read_exr", &read_exr);
}

} // namespace
} // namespace forceshade::python

PYBIND11_MODULE(_native, module) {
    forceshade::python::define(module);
}
