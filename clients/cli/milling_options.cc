#include <CLI/CLI.hpp>

#include "clients/cli/milling.h"

namespace rmlcell::cli {
namespace {

struct OptionsOfABlock {
  CLI::Option* stock;  // that all others need
  CLI::Option* target;
};

OptionsOfABlock AddBlockOptions(CLI::App& verb, BlockOptions& options) {
  CLI::Option* stock =
      verb.add_option("--stock", options.stock,
                      "100x80x10[@X,Y,TOP]: a block on a mill's table, mm from the work origin");
  CLI::Option* tool = verb.add_option(
      "--tool", options.tool,
      "flat:D, ball:D, vee:D:ANGLE[:TIP], with :flutes=N:flute=L:shank=D:holder=D@L: what mills it");
  stock->needs(tool);
  tool->needs(stock);
  verb.add_option(
          "--cell", options.cell_mm,
          "edge of the cells that the block is looked at in, mm; default 0.1, less for a tool below 0.4 mm")
      ->needs(stock);
  verb.add_option(
          "--material", options.material,
          "foam, wax, plastic, wood, pcb or aluminium: judge what an edge of the tool takes "
          "off (it needs flutes=N)")
      ->needs(stock);
  verb.add_option("--rpm", options.rpm,
                  "of a spindle that is set by hand; default: as the program says")
      ->check(CLI::Range(1.0, 1e6))
      ->needs(stock);
  CLI::Option* target =
      verb.add_option("--target", options.target,
                      "what should be left: a height map, an STL, or another program")
          ->needs(stock);
  return {stock, target};
}

CLI::Option* AddTargetTolerance(CLI::App& verb, BlockOptions& options) {
  return verb
      .add_option("--target-tolerance", options.target_tolerance_mm,
                  "up to which a difference is none, mm; default 0.1")
      ->check(CLI::Range(0.0, 1000.0));
}

CLI::Option* AddStlTolerance(CLI::App& verb, double& tolerance_mm) {
  return verb
      .add_option("--stl-tolerance", tolerance_mm,
                  "how far its surface may be off, mm; default 0.01")
      ->check(CLI::Range(0.0, 1000.0));
}

}  // namespace

void AddJobMillingOptions(CLI::App& verb, JobMillingOptions& options) {
  const OptionsOfABlock block = AddBlockOptions(verb, options.block);
  verb.add_option("--target-slot", options.target_slot,
                  "what should be left: what the program of this slot leaves")
      ->check(CLI::Range(1, 99))
      ->needs(block.stock)
      ->excludes(block.target);
  AddTargetTolerance(verb, options.block)->needs(block.stock);
  CLI::Option* products =
      verb.add_option(
              "--products", options.products,
              "of relief,height-map,height-grid,stl,target: what of the block the job leaves; default relief")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->check(CLI::IsMember({"relief", "height-map", "height-grid", "stl", "target"}))
          ->needs(block.stock);
  AddStlTolerance(verb, options.stl_tolerance_mm)->needs(products);
}

void AddMillingOptions(CLI::App& verb, MillingOptions& options) {
  const OptionsOfABlock block = AddBlockOptions(verb, options.block);
  CLI::Option* stl =
      verb.add_option("--stl", options.stl, "write what is left of the block, a closed body")
          ->needs(block.stock);
  AddStlTolerance(verb, options.stl_tolerance_mm)->needs(stl);
  verb.add_option("--relief", options.relief,
                  "write a shaded picture of what is left, from above (PNG)")
      ->needs(block.stock);
  verb.add_option("--height-map", options.height_map,
                  "write the heights of what is left as a grey picture of 16 bits (PNG)")
      ->needs(block.stock);
  AddTargetTolerance(verb, options.block)->needs(block.target);
  verb.add_option("--target-png", options.target_png,
                  "write a picture of what is too deep (red) and left too much (blue)")
      ->needs(block.target);
}

}  // namespace rmlcell::cli
