#include "rom_file.hpp"

#include "../../lib/io/hdf5_image.hpp"

namespace tact {
namespace {

/// Both directions go through one list of fields (`visit` below), so that none is written and not read.
class Saving {
public:
    template <class T> void field(const std::string& name, const T& value) { write(name, value); }
    /// Whether an optional part is there.
    template <class T> bool present(const std::string&, const std::optional<T>& part) { return part.has_value(); }
    std::string image() const { return writer_.image(); }

private:
    void write(const std::string& name, const DenseMatrix& x) { writer_.write(name, x); }
    void write(const std::string& name, const Vector& x) { writer_.write(name, x); }
    void write(const std::string& name, const std::vector<std::string>& x) { writer_.write(name, x); }
    void write(const std::string& name, const std::string& x) { writer_.write(name, std::vector{x}); }
    void write(const std::string& name, double x) { writer_.write(name, Vector(Vector::Constant(1, x))); }
    void write(const std::string& name, long x) { writer_.write(name, std::vector{x}); }
    void write(const std::string& name, bool x) { writer_.write(name, std::vector{x ? 1L : 0L}); }
    void write(const std::string& name, DualSigns x) { write(name, x == DualSigns::any); }
    void write(const std::string& name, const std::vector<Index>& x) { writer_.write(name, x); }
    void write(const std::string& name, const std::vector<double>& x) {
        writer_.write(name, Vector(Eigen::Map<const Vector>(x.data(), static_cast<Index>(x.size()))));
    }
    void write(const std::string& name, const std::vector<Parameter>& x) {
        DenseMatrix columns(x.empty() ? 0 : x.front().size(), static_cast<Index>(x.size()));
        for (std::size_t k = 0; k < x.size(); ++k) columns.col(static_cast<Index>(k)) = x[k];
        writer_.write(name, columns);
    }
    void write(const std::string& name, const Matrix& A) {
        if (const Vector* d = A.diagonal_entries())
            writer_.write(name + "/diagonal", *d);
        else
            writer_.write(name + "/dense", A.to_dense());
    }
    Hdf5Writer writer_;
};

class Loading {
public:
    Loading(std::string image, std::string path) : reader_(std::move(image), path), path_(std::move(path)) {}
    template <class T> void field(const std::string& name, T& value) { read(name, value); }
    template <class T> bool present(const std::string& name, std::optional<T>& part) {
        if (reader_.has(name)) part.emplace();
        return part.has_value();
    }

private:
    void read(const std::string& name, DenseMatrix& x) { x = reader_.matrix(name); }
    void read(const std::string& name, Vector& x) { x = reader_.vector(name); }
    void read(const std::string& name, std::vector<std::string>& x) { x = reader_.texts(name); }
    void read(const std::string& name, std::string& x) { x = one(name, reader_.texts(name)); }
    void read(const std::string& name, double& x) {
        const Vector all = reader_.vector(name);
        x = one(name, std::vector<double>(all.begin(), all.end()));
    }
    void read(const std::string& name, long& x) { x = one(name, reader_.integers(name)); }
    void read(const std::string& name, bool& x) { x = one(name, reader_.integers(name)) != 0; }
    void read(const std::string& name, DualSigns& x) {
        x = one(name, reader_.integers(name)) != 0 ? DualSigns::any : DualSigns::non_negative;
    }
    void read(const std::string& name, std::vector<Index>& x) { x = reader_.integers(name); }
    void read(const std::string& name, std::vector<double>& x) {
        const Vector all = reader_.vector(name);
        x.assign(all.begin(), all.end());
    }
    void read(const std::string& name, std::vector<Parameter>& x) {
        const DenseMatrix columns = reader_.matrix(name);
        x.clear();
        for (Index k = 0; k < columns.cols(); ++k) x.emplace_back(columns.col(k));
    }
    void read(const std::string& name, Matrix& A) {
        A = reader_.has(name + "/diagonal") ? Matrix::diagonal(reader_.vector(name + "/diagonal"))
                                            : Matrix(reader_.matrix(name + "/dense"));
    }
    template <class T> T one(const std::string& name, const std::vector<T>& all) const {
        if (all.size() != 1)
            throw InputError("load_reduced_model: " + path_ + ": " + name + " holds " + std::to_string(all.size()) +
                             " entries, expected 1");
        return all.front();
    }

    Hdf5Reader reader_;
    std::string path_;
};

template <class Archive, class Series> void visit_series(Archive& archive, const std::string& in, Series& series) {
    archive.field(in + "/lower", series.lower);
    archive.field(in + "/upper", series.upper);
    archive.field(in + "/counts", series.counts);
    archive.field(in + "/coefficients", series.coefficients);
}

template <class Archive, class Table> void visit_table(Archive& archive, const std::string& in, Table& table) {
    archive.field(in + "/dt", table.grid.dt);
    archive.field(in + "/steps", table.grid.steps);
    archive.field(in + "/t0", table.grid.t0);
    archive.field(in + "/left", table.left);
    archive.field(in + "/right", table.right);
    archive.field(in + "/jumps", table.jumps);
}

template <class Archive, class Problem> void visit_problem(Archive& archive, Problem& p) {
    if (archive.present("problem/M", p.M)) archive.field("problem/M", *p.M);
    if (archive.present("problem/D", p.D)) archive.field("problem/D", *p.D);
    archive.field("problem/K", p.K);
    archive.field("problem/B", p.B);
    archive.field("problem/c", p.c.modes);
    archive.field("problem/f", p.f.modes);
    archive.field("problem/u0", p.u0);
    archive.field("problem/v0", p.v0);
}

template <class Archive, class Checks> void visit_checks(Archive& archive, Checks& checks) {
    archive.field("checks/rows", checks.rows);
    archive.field("checks/B_U", checks.B_U);
    archive.field("checks/gap", checks.gap);
    archive.field("checks/unknowns", checks.unknowns);
    archive.field("checks/M_U", checks.M_U);
    archive.field("checks/D_U", checks.D_U);
    archive.field("checks/K_U", checks.K_U);
    archive.field("checks/load", checks.load);
    archive.field("checks/multipliers", checks.multipliers);
    archive.field("checks/stride", checks.stride);
    archive.field("checks/calibrated_on", checks.calibrated_on);
    archive.field("checks/penetration_weight", checks.penetration_weight);
    archive.field("checks/residual_weight", checks.residual_weight);
    archive.field("checks/tolerance", checks.tolerance);
    archive.field("checks/least_effectivity", checks.least_effectivity);
    archive.field("checks/median_effectivity", checks.median_effectivity);
    archive.field("checks/largest_effectivity", checks.largest_effectivity);
}

template <class Archive, class Data> void visit(Archive& archive, Data& d) {
    archive.field("parameters/names", d.names);
    archive.field("parameters/lower", d.lower);
    archive.field("parameters/upper", d.upper);
    archive.field("basis/U", d.basis.U);
    archive.field("basis/U_lambda", d.basis.U_lambda);
    archive.field("basis/signs", d.basis.signs);
    visit_problem(archive, d.centre);
    visit_table(archive, "time/load", d.load);
    visit_table(archive, "time/gap", d.moving);
    archive.field("gap/terms", d.gap.terms);
    visit_series(archive, "gap/theta", d.gap.theta);
    archive.field("gap/rows", d.gap_rows);
    archive.field("others/terms", d.others.terms);
    visit_series(archive, "others/theta", d.others.theta);
    archive.field("others/parts", d.parts);
    archive.field("others/affine", d.affine);
    archive.field("parameters/error", d.parameter_error);
    archive.field("method/integrator", d.method.integrator);
    archive.field("method/dt", d.method.grid.dt);
    archive.field("method/steps", d.method.grid.steps);
    archive.field("method/t0", d.method.grid.t0);
    archive.field("method/compliance", d.method.compliance);
    archive.field("method/screening", d.method.screening);
    archive.field("quantities/names", d.quantities.names);
    archive.field("quantities/Q", d.quantities.Q);
    archive.field("quantities/Q_lambda", d.quantities.Q_lambda);
    visit_checks(archive, d.checks);
    archive.field("training/samples", d.training.samples);
    archive.field("training/max_indicators", d.training.max_indicators);
    archive.field("training/stop_reason", d.training.stop_reason);
}

}  // namespace

void save_reduced_model(const std::filesystem::path& path, const ReducedModelData& model) {
    Saving saving;
    visit(saving, model);
    write_sealed_file(path, reduced_model_file, "tact " TACT_VERSION, saving.image());
}

ReducedModelData load_reduced_model(const std::filesystem::path& path) {
    Loading loading(read_sealed_file(path, reduced_model_file), path.string());
    ReducedModelData data;
    visit(loading, data);
    return ReducedModel(std::move(data)).data();
}

}  // namespace tact
