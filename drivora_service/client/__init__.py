"""The typed client: over HTTP, or to the application in the same process.

A client of a service, and one of an application::

    with Client("http://127.0.0.1:8000") as client:
        batch = client.post_batch([document], agent="idm").batch
        for run in client.wait_for_batch(batch.id):
            print(run.id, run.status, run.violations)

    with Client(transport=ApplicationTransport(app)) as client:
        print(client.readiness())
"""

from drivora_service.client.async_client import AsyncClient
from drivora_service.client.call import Call, Document, Language, Listing, ObservationForm
from drivora_service.client.client import Client
from drivora_service.client.listening import Event
from drivora_service.client.transport import ApplicationTransport, AsyncApplicationTransport
from drivora_service.observations.trace_files.trace_rows import TraceRows

__all__ = [
    "ApplicationTransport",
    "AsyncApplicationTransport",
    "AsyncClient",
    "Call",
    "Client",
    "Document",
    "Event",
    "Language",
    "Listing",
    "ObservationForm",
    "TraceRows",
]
