// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/mpi_compile.h"

#include <fmt/format.h>
#include <mpi.h>

#include <limits>

#include "offline/cli/compile_options.h"
#include "offline/learn/bin_codec.h"
#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "offline/mpi/mpi_job.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

void send_bin(std::size_t index, const ViewpointBin& bin) {
  const std::vector<std::byte> bytes = encode_bin(bin);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::logic_error("bin too large");
  MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, static_cast<int>(index),
           MPI_COMM_WORLD);
}

void receive_bin(std::vector<ViewpointBin>& bins) {
  MPI_Status status;
  MPI_Probe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &status);
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  MPI_Recv(bytes.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  bins.at(static_cast<std::size_t>(status.MPI_TAG)) = decode_bin(bytes);
}

void run(const CompileArguments& a) {
  // Everything that may refuse the input comes before MPI starts, so that a bad mesh is one clear line.
  const LearnParameters parameters = a.parameters();
  const StandingObject object = load_standing_object(a.mesh, a.mesh_arguments.options());
  const auto boxes = lay_out_bins(parameters, object.symmetry_deg);
  const MpiJob job;
  const auto first = static_cast<std::size_t>(job.rank);
  const auto stride = static_cast<std::size_t>(job.ranks);
  std::vector<ViewpointBin> bins = learn_bins(object, parameters, boxes, 1, first, stride, {});
  if (job.rank != 0) {
    for (std::size_t i = first; i < boxes.size(); i += stride) send_bin(i, bins[i]);
    return;
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i % stride != 0) receive_bin(bins);
  }
  const ObjectModel model =
      assemble_model(object, parameters, std::move(bins), a.mesh.filename().string(), a.object_id());
  write_model(model, a.output);
  fmt::print("{}: {} bins learnt by {} ranks\n", a.output.string(), model.bins.size(), job.ranks);
}

}  // namespace

CLI::App* add_mpi_compile_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<CompileArguments>();
  CLI::App* command = app.add_subcommand("compile", "mesh -> compiled model, bins spread over the ranks");
  command->footer("Example:\n  mpirun -n 4 sextant-mpi compile mug.stl --units mm -o mug.sxm");
  arguments->add_to(*command);
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
