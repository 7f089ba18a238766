#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/blind.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_blind(CLI::App& app, Action& action) {
  const auto options = std::make_shared<BlindOptions>();
  CLI::App* verb = app.add_subcommand(
      "blind", "prove the diagnosis on cases whose physics is concealed from it");
  verb->add_option("--cases", options->plan.cases,
                   "how many: half of them single effects, then pairs, devices outside the "
                   "vocabulary and nasty ones")
      ->check(CLI::Range(1, 9999))
      ->capture_default_str();
  auto* const nulls = verb->add_option("--nulls", "how many devices without effects, instead");
  nulls->check(CLI::Range(1, 9999))->excludes("--cases");
  verb->add_option("--seed", options->plan.seed, "decides everything")->capture_default_str();
  verb->add_option("--out", options->out,
                   "folder of seals and answers; blind-SEED when not given. Run again on the same "
                   "folder, the campaign goes on where it was left");
  verb->add_option("--shard", options->shard, "i/N: only every N-th case, for N computers")
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "cases at a time; 0: one a core")
      ->check(CLI::Range(0, 1024));
  verb->add_option("--diagnose", options->diagnose,
                   "another program to hold to the same cases, called as PROGRAM diagnose FOLDER "
                   "--json FILE --threads N");
  verb->add_flag("--keep", options->keep, "keep recordings and answers, some 6 MB a case");
  verb->add_flag("--markdown", options->markdown, "print tables as a document takes them");
  verb->add_option("--json", options->json, "write the figures to this file");
  verb->require_subcommand(0, 1);

  CLI::App* merge = verb->add_subcommand("merge", "put the shards of one campaign together");
  merge->add_option("folders", options->shards, "folders of the shards")->required();
  merge->add_option("--out", options->out, "folder of the whole campaign")->required();
  merge->add_flag("--markdown", options->markdown, "print tables as a document takes them");
  merge->add_option("--json", options->json, "write the figures to this file");

  verb->callback([options, nulls, &action, merge] {
    if (merge->parsed()) return;
    if (nulls->count() > 0) {
      options->plan.nulls = true;
      options->plan.cases = nulls->as<std::size_t>();
    }
    action = [options] {
      return run_blind(*options);
    };
  });
  merge->callback([options, &action] {
    action = [options] {
      return merge_blind(*options);
    };
  });
}

}  // namespace teleop
