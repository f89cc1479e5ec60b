"""How much a service takes in one request."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from biped_ros.requests import REQUEST_LIMIT_BYTES, is_too_large

LIMIT = REQUEST_LIMIT_BYTES


def parameters(value, number=1):
    message = Parameter("name", value=value).to_parameter_msg()
    return SetParameters.Request(parameters=[message] * number)


@pytest.mark.parametrize(
    "request_",
    [Trigger.Request(), SetBool.Request(data=True), parameters([1.0] * 1000),
     parameters("sound", 500), DescribeParameters.Request(names=["a.name"] * 900)],
)  # fmt: skip
def test_what_people_ask_is_taken(request_):
    assert not is_too_large(request_)


@pytest.mark.parametrize(
    "request_",
    [
        DescribeParameters.Request(names=[""] * 1025),
        DescribeParameters.Request(names=["x" * LIMIT]),
        parameters("x" * LIMIT),
        parameters(["x" * 1000] * 70),
        parameters([1.0] * LIMIT),
        parameters(True, 1025),
    ],
    ids=["names", "a name", "a text", "texts", "numbers", "parameters"],
)
def test_what_takes_more_than_the_limit_is_too_large(request_):
    assert is_too_large(request_)


@given(st.lists(st.text(alphabet="ab", max_size=3000), max_size=40))
def test_a_request_within_the_limit_is_taken_and_one_beyond_is_not(names):
    size = sum(64 + len(name) for name in names)
    assert is_too_large(DescribeParameters.Request(names=names)) == (size > LIMIT)
