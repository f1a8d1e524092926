"""Tests that distillation trains only the student, and that student and teacher get the same
observations."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import torch
from omegaconf import OmegaConf

from mitigate.agents.adapters import backbone_sha
from mitigate.agents.topological import TopologicalAgent
from mitigate.core import checkpoint, conf, seeding
from mitigate.core.checkpoint import weights_sha
from mitigate.corruptions import DEPTH, Schedule
from mitigate.recipes.adapt import FRESH, HELD, Adapt, AdaptViews, changed_views
from mitigate.recipes.distil import Distil, DistilViews, feature_loss, policy_kl
from mitigate.recipes.imitate import Imitate, imitation
from mitigate.training.states import checkpoints
from mitigate.training.trainer import Trainer
from mitigate.worlds.apartments import simulator
from mitigate.worlds.apartments.tasks import DrawnEpisodes
from mitigate.worlds.apartments.world import ApartmentsWorld
from tests.tiny import assemble

SMALL = {"heads": 2, "text_layers": 1, "layers": 1}
ADAPTERS = {"target_modules": [r"(rgb|depth)_encoder\.stages\.1"], "ring": [r"rgb.*stages\.2"]}
SOURCES = {"world": partial(ApartmentsWorld, 32, 2), "training": DrawnEpisodes(2)}
EPISODES = {"episodes": 1, "follow_oracle": 1.0, **SOURCES}
VIEWS = {"panoramas": 1, "schedule": Schedule("per_episode", 0.6), **SOURCES}


def small(seed: int = 0, **options) -> TopologicalAgent:
    """Return an untrained agent that predicts free space everywhere."""
    seeding.seed_everything(seed, "agent")
    agent = TopologicalAgent(16, SMALL, size=32, **options)
    with torch.no_grad():
        agent.waypoint_head.out.bias.fill_(8.0)
    return agent


def missing_data() -> Schedule:
    """A schedule that removes half of the depth in every frame."""
    return Schedule("per_episode", 1.0, clean_share=0.0, names=("missing_data",))


@pytest.fixture(autouse=True, scope="module")
def short_episodes():
    """A world whose episodes end after 40 steps."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator, "MAX_STEPS", 40)
        yield


@pytest.fixture(scope="module")
def teacher(tmp_path_factory) -> str:
    folder = tmp_path_factory.mktemp("teacher")
    checkpoint.save_weights(small(seed=1), folder)
    return str(folder)


@pytest.fixture(scope="module")
def recipe(teacher) -> Distil:
    return assemble(Distil, small(), teacher=teacher, schedule=missing_data(), **EPISODES)


@pytest.fixture(scope="module")
def batch(recipe) -> dict:
    recipe.train()
    return recipe.batch(0)


def gradients(recipe: Distil, loss: torch.Tensor) -> set[str]:
    """Return the names of the agent's parts that get a gradient from ``loss``; check that the
    teacher gets none."""
    recipe.zero_grad()
    loss.backward(retain_graph=True)
    assert all(p.grad is None for p in recipe.teacher.parameters())
    return {
        part
        for part, module in recipe.agent.parts().items()
        if any(p.grad is not None and p.grad.abs().sum() > 0 for p in module.parameters())
    }


def test_each_loss_term_reaches_its_parts_only(recipe, batch):
    values = recipe(batch)
    everything = {"rgb_encoder", "depth_encoder", "planner"}
    assert gradients(recipe, values["kl"]) == everything
    assert gradients(recipe, values["feat_nodes"]) == everything
    assert gradients(recipe, values["feat_views"]) == {"rgb_encoder", "depth_encoder"}
    assert gradients(recipe, values["waypoints"]) == {"depth_encoder", "waypoint_head"}


def test_loss_is_the_sum_of_its_terms(recipe, batch):
    """The expected loss is w_il L_il + w_kl T^2 KL + w_feat sum(MSE / teacher's variance)."""
    recipe.eval()
    with torch.no_grad():
        values = recipe(batch)
        out = recipe.agent.decide(batch["decisions"])
        base = imitation(out, batch["decisions"], recipe.loss_weights)
    recipe.train()
    expected = recipe.w_il * base["loss"] + recipe.w_kl * recipe.temperature**2 * values["kl"]
    expected += recipe.w_feat * (values["feat_nodes"] + values["feat_views"])
    assert recipe.temperature != 1.0 and recipe.w_kl > 0 and recipe.w_feat > 0
    assert float(values["loss"]) == pytest.approx(float(expected), rel=1e-5)


def test_matched_features_count_in_units_of_the_teachers_variance():
    # the variance of the teacher's features is 20 / 3
    teacher = torch.tensor([[0.0, 2.0], [4.0, 6.0]])
    student = teacher + torch.tensor([[1.0, -1.0], [2.0, 0.0]])
    assert float(feature_loss(student, teacher)) == pytest.approx(1.5 / (20 / 3))
    assert float(feature_loss(10 * student, 10 * teacher)) == pytest.approx(1.5 / (20 / 3))


def test_policy_kl_is_that_of_softened_policies():
    student, teacher = torch.tensor([[2.0, 0.0]]), torch.tensor([[0.0, 4.0]])
    p = torch.tensor([1.0, np.e**2]) / (1 + np.e**2)
    q = torch.tensor([np.e, 1.0]) / (1 + np.e)  # KL(q || p) has a different value
    expected = float((p * (p / q).log()).sum())  # at temperature 2
    assert float(policy_kl(student, teacher, 2.0)) == pytest.approx(expected, abs=1e-6)


def test_teacher_and_student_answer_over_the_same_candidates(recipe, batch):
    """The teacher uses the student's waypoints; its own waypoints, from clean depth, would
    differ."""
    decisions = batch["decisions"]
    student = recipe.agent.decide(decisions).logits
    with torch.no_grad():
        expected = recipe.teacher.decide(decisions, clean=True).logits
    assert torch.equal(torch.isfinite(student), torch.isfinite(expected))
    assert torch.equal(torch.isfinite(student), decisions.allowed)
    assert not np.allclose(decisions.depth.numpy(), 0) and torch.isfinite(
        policy_kl(student, expected, 2.0)
    )


@pytest.mark.slow
def test_loss_without_teacher_terms_is_imitation(teacher, tmp_path):
    shas = []
    for kind in ("imitation", "distillation"):
        agent = small()
        common = {"schedule": missing_data(), "seed": 3, **EPISODES}
        output = (
            assemble(Imitate, agent, **common)
            if kind == "imitation"
            else assemble(Distil, agent, teacher=teacher, w_kl=0.0, w_feat=0.0, **common)
        )
        Trainer(output, steps=2, folder=tmp_path / kind, seed=3).fit()
        shas.append(weights_sha(agent))
    assert shas[0] == shas[1] != weights_sha(small())


def test_teacher_stays_equal_and_student_moves(teacher, tmp_path):
    agent = small()
    objective = assemble(Distil, agent, teacher=teacher, schedule=missing_data(), **EPISODES)
    before, start = weights_sha(objective.teacher), weights_sha(agent)
    objective.train()
    assert not objective.teacher.training
    Trainer(objective, steps=2, folder=tmp_path, seed=0).fit()
    assert weights_sha(objective.teacher) == before == objective.identity()["teacher_sha256"]
    assert weights_sha(agent) != start


def test_policy_kl_is_zero_for_equal_policies_and_ignores_masks():
    student = torch.tensor([[1.0, 2.0, float("-inf")]], requires_grad=True)
    assert policy_kl(student, student.detach(), 2.0) == 0
    teacher = torch.tensor([[3.0, 1.0, float("-inf")]])
    matches = policy_kl(student, teacher, 1.0)
    p = torch.tensor([3.0, 1.0]).softmax(0)
    q = torch.tensor([1.0, 2.0]).softmax(0)
    assert matches.item() == pytest.approx((p * (p / q).log()).sum().item(), rel=1e-5)
    matches.backward()
    assert torch.isfinite(student.grad).all()


@pytest.mark.parametrize(
    ("kind", "modality"),
    [
        ("views", "rgb"),
        pytest.param("adapters", "depth", marks=pytest.mark.slow),
        pytest.param("views", "depth", marks=pytest.mark.slow),
        pytest.param("adapters", "rgb", marks=pytest.mark.slow),
    ],
)
def test_resumed_run_ends_with_the_same_bits(kind, modality, teacher, tmp_path):
    def output():
        if kind == "views":
            return assemble(DistilViews, small(), modality=modality, teacher=teacher, **VIEWS)
        return assemble(AdaptViews, small(adapters=ADAPTERS), modality=modality, **VIEWS)

    whole, first, second = output(), output(), output()
    Trainer(whole, steps=3, folder=tmp_path / "whole", seed=0).fit()
    Trainer(first, steps=3, folder=tmp_path / "cut", seed=0, save_every=1).fit()
    checkpoints(tmp_path / "cut")[-1].unlink()  # resumes from step 2
    Trainer(second, steps=3, folder=tmp_path / "cut", seed=0, save_every=1).fit()
    assert weights_sha(whole.agent) == weights_sha(second.agent)


def test_adapters_train_alone(tmp_path):
    agent = small(adapters=ADAPTERS)
    objective = assemble(AdaptViews, agent, modality="rgb", **VIEWS)
    start, backbone = weights_sha(agent), backbone_sha(agent)
    Trainer(objective, steps=2, folder=tmp_path, seed=0).fit()
    assert backbone_sha(agent) == backbone and weights_sha(agent) != start


@pytest.mark.slow
def test_adapt_views_scales_adapters_at_the_end(tmp_path):
    agents = [small(adapters=ADAPTERS) for _ in range(2)]
    for agent, strength in zip(agents, (1.0, 0.25), strict=True):
        objective = assemble(AdaptViews, agent, modality="rgb", **VIEWS, strength=strength)
        Trainer(objective, steps=2, folder=tmp_path / f"{strength}", seed=0, save_every=1).fit()
    full, part = (dict(agent.named_parameters()) for agent in agents)
    for name, weight in full.items():
        scaled = ".adapter.up." in name or ".adapter.share." in name
        times = 0.25 if scaled and name.startswith("rgb_encoder") else 1.0
        assert torch.equal(part[name], weight * times), name
    resumed = small(adapters=ADAPTERS)
    checkpoints(tmp_path / "0.25")[-1].unlink()  # resumes from step 1
    objective = assemble(AdaptViews, resumed, modality="rgb", **VIEWS, strength=0.25)
    Trainer(objective, steps=2, folder=tmp_path / "0.25", seed=0, save_every=1).fit()
    assert weights_sha(resumed) == weights_sha(agents[1]) != weights_sha(agents[0])
    with pytest.raises(ValueError, match="strength must be above 0 and at most 1, got 0"):
        assemble(AdaptViews, resumed, modality="rgb", **VIEWS, strength=0)


@pytest.mark.slow
def test_gate_learns_which_views_are_corrupted(tmp_path):
    agent = small(adapters={**ADAPTERS, "gates": ["rgb_encoder.stem"]})
    objective = assemble(AdaptViews, agent, modality="rgb", **VIEWS, own=True)
    batch = objective.batch(0)
    (gate,), corrupted = objective.gates, changed_views(batch["frames"], batch["clean"])
    objective(batch)
    wrong = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(DistilViews, "forward", lambda *_: {"loss": torch.zeros(())})
        for sign in (9.0, -9.0):
            gate.judged.logits = torch.where(corrupted, sign, -sign).reshape(
                gate.judged.logits.shape
            )
            wrong.append(float(objective(batch)["gate"]))
    assert wrong[0] < 0.01 < 5 < wrong[1]
    values = objective(batch)
    assert values["gate"] > 0 and {"opened_corrupted", "opened_clean"} <= set(values)
    start = agent.rgb_encoder.stem.adapter.judge.weight.clone()
    Trainer(objective, steps=2, folder=tmp_path, seed=0, lr=1e-2, warmup=0).fit()
    assert not torch.equal(agent.rgb_encoder.stem.adapter.judge.weight, start)


def test_gate_threshold_is_set_on_held_out_clean_views():
    agent = small(adapters={**ADAPTERS, "gates": ["rgb_encoder.stem"]})
    objective = assemble(
        AdaptViews, agent, modality="rgb", **VIEWS, own=True, touched=0.25, held=4
    ).eval()
    assert agent.rgb_encoder.stem.adapter.threshold == 0
    with torch.no_grad():
        objective.finish()
        values = objective.evaluate(0)
        again = objective.evaluate(0)
    gate = agent.rgb_encoder.stem.adapter
    assert gate.threshold != 0 and values == again
    with torch.no_grad():
        logits, corrupted = objective._judged(gate, HELD, 4, clean=True)
    opened = float((logits > 0).float().mean())
    assert not corrupted.any() and opened == pytest.approx(0.25, abs=0.1)
    drawn = [objective.poses.jobs(step) for step in (HELD, FRESH)]
    assert not {job[0] for jobs in drawn for job in jobs} & {*range(100_000)}
    assert 0 <= values["clean_opened"] < 1 and 0 <= values["corrupted_opened"] <= 1
    with pytest.raises(ValueError, match="touched must be above 0 and below 1, got 0"):
        assemble(AdaptViews, agent, modality="rgb", **VIEWS, touched=0)


def with_statistics(**options) -> TopologicalAgent:
    """An agent whose encoders have normalisation layers with running statistics, some with weights
    and some without."""
    agent = small(**options)
    for encoder, affine in ((agent.rgb_encoder, True), (agent.depth_encoder, False)):
        block = encoder.stages[0]
        norm = torch.nn.BatchNorm2d(block.norm1.num_channels, affine=affine)
        block.norm1 = torch.nn.Sequential(block.norm1, norm)
    return agent


def statistics(agent) -> dict[str, torch.Tensor]:
    return {name: value.clone() for name, value in agent.named_buffers() if "running" in name}


@pytest.mark.parametrize(
    ("kind", "learning"),
    [
        ("adapters on episodes", set()),
        ("adapters on views", set()),
        ("one encoder on episodes", {"rgb_encoder"}),
        ("one encoder on views", {"depth_encoder"}),
    ],
)
def test_frozen_normalisations_keep_their_statistics(kind, learning, tmp_path):
    agent = with_statistics(adapters=ADAPTERS if kind.startswith("adapters") else None)
    before, settings = statistics(agent), {"schedule": missing_data(), **EPISODES}
    output = {
        "adapters on episodes": lambda: assemble(Adapt, agent, **settings),
        "adapters on views": lambda: assemble(AdaptViews, agent, modality="depth", held=1, **VIEWS),
        "one encoder on episodes": lambda: assemble(
            Distil, agent, teacher="start", train_parts=["rgb_encoder"], **settings
        ),
        "one encoder on views": lambda: assemble(
            DistilViews, agent, modality="depth", teacher="start", **VIEWS
        ),
    }[kind]()
    Trainer(output, steps=1, folder=tmp_path, seed=0).fit()
    after = statistics(agent)
    moved = {name.partition(".")[0] for name in before if not before[name].equal(after[name])}
    assert moved == learning


def test_changed_backbone_is_rejected(tmp_path):
    agent = small(adapters=ADAPTERS)
    agent.rgb_encoder.register_buffer("count", torch.zeros(1))
    agent.rgb_encoder.register_forward_hook(
        lambda encoder, *_: setattr(encoder, "count", encoder.count + 1)
    )
    objective = assemble(Adapt, agent, schedule=missing_data(), **EPISODES)
    with pytest.raises(ValueError, match=r"The backbone of TopologicalAgent has changed"):
        Trainer(objective, steps=1, folder=tmp_path, seed=0).fit()


def test_views_differ_where_pixels_differ_and_holes_compare_equal():
    clean = torch.ones(2, 2, 4, 4, 1)
    clean[0, 0, 0] = torch.nan
    frames = clean.clone()
    frames[1, 0, 2, 2] = 0.5
    assert changed_views(frames, clean).tolist() == [False, False, True, False]


def test_stage_may_draw_corruptions_of_its_sensor_only():
    teacher = {"teacher": "start", "modality": "depth"}
    both, own_value = (
        assemble(DistilViews, small(), **VIEWS, **teacher, own=own_value)
        for own_value in (False, True)
    )
    assert set(own_value.poses.schedule.names) == set(DEPTH) < set(both.poses.schedule.names)
    with pytest.raises(ValueError, match="must contain a depth corruption"):
        Schedule("per_episode", 0.6, names=("spatter",)).only("depth")


def test_missing_teacher_names_the_command(tmp_path):
    with pytest.raises(FileNotFoundError, match="make train RECIPE=da_per_episode"):
        assemble(Distil, small(), teacher=str(tmp_path), schedule=missing_data(), **EPISODES)


def test_adapters_alone_are_no_teacher():
    with pytest.raises(ValueError, match="holds only adapters"):
        assemble(
            DistilViews,
            small(),
            modality="rgb",
            teacher="checkpoints/hardened/conv_adapter",
            **VIEWS,
        )


def test_teacher_option_applies_to_all_stages():
    for recipe in ("ts_distill", "stacked"):
        cfg = conf.load_config("train", [f"recipe={recipe}", "teacher=mine"])
        assert {stage.recipe.teacher for stage in cfg.stages.values()} == {"mine"}


@pytest.mark.parametrize(
    ("recipe", "teacher"), [("ts_distill", "checkpoints/teacher"), ("stacked", "checkpoints/base")]
)
def test_any_stage_of_a_distillation_can_be_left_out(recipe, teacher):
    for left_out in ("views_rgb", "views_depth", "episodes"):
        cfg = conf.load_config("train", [f"recipe={recipe}", f"stages.{left_out}=null"])
        OmegaConf.resolve(cfg.stages)
        assert [stage.recipe.teacher for stage in cfg.stages.values() if stage] == [teacher] * 2


def test_frozen_views_are_no_part_of_the_loss(teacher, monkeypatch):
    parts = {"train_parts": ("planner",), "schedule": missing_data(), **EPISODES}
    frozen = assemble(Distil, small(), teacher=teacher, **parts).eval()
    with_views = frozen(frozen.batch(0))
    decide = frozen.agent.decide

    def without_views(decisions):
        out = decide(decisions)
        return replace(out, features={"nodes": out.features["nodes"]})

    monkeypatch.setattr(frozen.agent, "decide", without_views)
    without = frozen(frozen.batch(0))
    assert "feat_views" in with_views and "feat_views" not in without
    assert with_views["loss"] == without["loss"]


@pytest.mark.slow
def test_run_is_not_resumed_under_another_teacher(tmp_path):
    sources = []
    for seed in (1, 2):
        checkpoint.save_weights(small(seed), tmp_path / "teacher")
        objective = assemble(
            DistilViews, small(), modality="rgb", teacher=str(tmp_path / "teacher"), **VIEWS
        )
        sources.append(objective.identity()["teacher_sha256"])
        trainer = Trainer(objective, steps=1, folder=tmp_path / "run", config=objective.identity())
        if seed == 1:
            trainer.fit()
    assert sources[0] != sources[1]
    with pytest.raises(ValueError, match="teacher_sha256"):
        trainer.fit()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"temperature": 0.0}, "temperature must be above 0, such as 2, got 0"),
        ({"w_kl": -1.0}, "w_kl must be a number from 0 to 1e.09, got -1"),
        (
            {"w_il": 0.0, "w_kl": 0.0, "w_feat": 0.0},
            "would be trained: w_il, w_kl and w_feat are 0",
        ),
    ],
)
def test_invalid_weights_are_rejected_by_name(options, words):
    with pytest.raises(ValueError, match=words):
        assemble(Distil, small(), teacher="start", schedule=missing_data(), **EPISODES, **options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"w_feat": -1.0}, "w_feat must be .* got -1"),
        ({"panoramas": 0}, "panoramas must be a whole number >= 1, got 0"),
    ],
)
def test_distil_views_rejects_invalid_numbers(options, words):
    with pytest.raises(ValueError, match=words):
        assemble(DistilViews, small(), modality="depth", teacher="start", **{**VIEWS, **options})


def test_rank_with_more_panoramas_weighs_more():
    objective = assemble(
        DistilViews, small(), modality="depth", teacher="start", **{**VIEWS, "panoramas": 3}
    )
    assert objective.weight(objective.batch(0)) == 3.0


def test_adapters_are_asked_for_where_there_are_none():
    with pytest.raises(ValueError, match="have no adapters"):
        assemble(AdaptViews, small(), modality="rgb", **VIEWS)


def test_gates_that_nothing_teaches_are_refused():
    gated = {**ADAPTERS, "gates": ["rgb_encoder.stem"]}
    with pytest.raises(ValueError, match=r"cannot train the gates.*recipe=harden"):
        assemble(DistilViews, small(adapters=gated), modality="rgb", teacher="start", **VIEWS)
    with pytest.raises(ValueError, match="cannot train the gates"):
        assemble(
            Imitate,
            small(adapters=gated),
            **SOURCES,
            schedule=missing_data(),
            train_parts=["adapters"],
        )
    assemble(
        DistilViews, small(adapters=gated), modality="depth", teacher="start", **VIEWS
    )  # has none
