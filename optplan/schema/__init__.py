"""The public form of jobs, robots, options and plans: pydantic models and the files they are kept in.

Inside, optplan works with the plain dataclasses of `optplan.domain`; these models stand at the door. They report all
errors at once, refuse NaN and infinity, convert units, and export as JSON Schema.
"""
