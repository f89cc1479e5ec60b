from setuptools import find_packages, setup

NAME = "biped_lab"

setup(
    name=NAME,
    version="0.2.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    package_data={NAME: ["studies/*.yaml", "report/*.css", "report/*.j2"]},
    entry_points={
        "biped.verbs": ["lab = biped_lab.verbs.lab:add_parser"],
        "biped.lab_verbs": [
            "compare = biped_lab.verbs.compare:add_parser",
            "power = biped_lab.verbs.power:add_parser",
            "report = biped_lab.verbs.report:add_parser",
            "run = biped_lab.verbs.run:add_parser",
            "status = biped_lab.verbs.status:add_parser",
        ],
        "biped.contestants": [
            "by_settings = biped_lab.learner_contestant:BY_SETTING",
            "cma_es = biped_lab.searches.cma_es:WHOLE",
            "cma_es_incremental = biped_lab.searches.cma_es:INCREMENTAL",
            "episodic_ps = biped_lab.rivals.episodic_ps:ENTRY",
            "genetic = biped_lab.searches.genetic:ENTRY",
            "linear_programming = biped_lab.searches.linear_programming:ENTRY",
            "online_ps = biped_lab.rivals.online_ps:ENTRY",
            "parp = biped_lab.rivals.parp:ENTRY",
            "random = biped_lab.rivals.random_choice:ENTRY",
            "sarsa_lambda = biped_lab.rivals.sarsa_lambda:ENTRY",
            "stable_baselines = biped_lab.searches.stable_baselines:ENTRY",
            "tail_search = biped_lab.searches.tail_search:ENTRY",
        ],
    },
)
